// Whether arrays are what most arrays of a loop are: NumPy's own, of float64,
// of the expected shape, with finite numbers below 1e154, so that a sum of
// squares is finite.
#pragma once
#include <cmath>
#include <initializer_list>

#include "../shared/python_signals.hpp"

namespace pliant::guard {

// Looks at one array after the other; once one was not as it should be, all is
// over.
class Look {
 public:
  bool good() const { return good_ && std::isfinite(squares_); }
  void refuse() { good_ = false; }

  void time(nb::handle value) {
    good_ = good_ && PyFloat_CheckExact(value.ptr());
    if (good_) squares_ += std::abs(PyFloat_AS_DOUBLE(value.ptr()));
  }
  void array(nb::handle value, std::initializer_list<long> shape) {
    if (!good_ || !(good_ = Py_TYPE(value.ptr()) == ndarray_type())) return;
    Py_buffer buffer;
    if (PyObject_GetBuffer(value.ptr(), &buffer, PyBUF_STRIDED_RO | PyBUF_FORMAT)) {
      PyErr_Clear();
      good_ = false;
      return;
    }
    good_ = buffer.format && std::strcmp(buffer.format, "d") == 0 && buffer.ndim == int(shape.size());
    int axis = 0;
    for (const long size : shape) good_ = good_ && buffer.shape[axis++] == size;
    if (good_) add(buffer, 0, static_cast<const char*>(buffer.buf));
    PyBuffer_Release(&buffer);
  }
  // None is good, too.
  void optional(nb::handle value, std::initializer_list<long> shape) {
    if (!value.is_none()) array(value, shape);
  }

 private:
  bool good_ = true;
  double squares_ = 0;

  static PyTypeObject* ndarray_type() {
    static const nb::object found = nb::module_::import_("numpy").attr("ndarray");
    return reinterpret_cast<PyTypeObject*>(found.ptr());
  }
  void add(const Py_buffer& buffer, int axis, const char* at) {
    if (axis == buffer.ndim) {
      const double x = *reinterpret_cast<const double*>(at);
      squares_ += x * x;
      return;
    }
    for (Py_ssize_t i = 0; i < buffer.shape[axis]; ++i) add(buffer, axis + 1, at + i * buffer.strides[axis]);
  }
};

}  // namespace pliant::guard
