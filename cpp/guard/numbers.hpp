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
    if (!good_) return;
    const PyArrayObject* array = doubles_of(value);
    if (!(good_ = array && PyArray_NDIM(array) == int(shape.size()))) return;
    int axis = 0;
    for (const long size : shape) good_ = good_ && PyArray_DIMS(array)[axis++] == size;
    if (good_) add(array, 0, PyArray_BYTES(const_cast<PyArrayObject*>(array)));
  }
  // None is good, too.
  void optional(nb::handle value, std::initializer_list<long> shape) {
    if (!value.is_none()) array(value, shape);
  }

 private:
  bool good_ = true;
  double squares_ = 0;

  void add(const PyArrayObject* array, int axis, const char* at) {
    if (axis == PyArray_NDIM(array)) {
      const double x = *reinterpret_cast<const double*>(at);
      squares_ += x * x;
      return;
    }
    const npy_intp step = PyArray_STRIDES(array)[axis];
    for (npy_intp i = 0; i < PyArray_DIMS(array)[axis]; ++i) add(array, axis + 1, at + i * step);
  }
};

}  // namespace pliant::guard
