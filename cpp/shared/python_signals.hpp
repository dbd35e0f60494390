// Signals of src/pliant/signals.py, read from C++ where they lie.
#pragma once
#include <nanobind/nanobind.h>

#include <cstring>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <vector>

#include "numpy_arrays.hpp"
#include "rows.hpp"

namespace pliant {

using namespace nb::literals;

inline std::string shape_text(const std::vector<size_t>& shape) {
  std::string s = "(";
  for (size_t i = 0; i < shape.size(); ++i) s += (i ? ", " : "") + std::to_string(shape[i]);
  return s + (shape.size() == 1 ? ",)" : ")");
}

inline nb::object read_attribute(nb::handle from, PyObject* name) {
  PyObject* value = PyObject_GetAttr(from.ptr(), name);
  if (!value) throw nb::python_error();
  return nb::steal(value);
}

// Numbers of somebody's array, kept alive while they are read; copied only where they do not lie side by side in rows
// or are no float64. What NumPy does not hold is read over the buffer protocol.
class Numbers {
 public:
  Numbers() = default;
  Numbers(const Numbers&) = delete;
  Numbers& operator=(const Numbers&) = delete;
  ~Numbers() { release(); }

  // Reads an array of the given shape; a first axis of -1 takes any length.
  Rows read(nb::handle value, const char* name, std::initializer_list<long> shape) {
    if (!lies_in_rows(value)) {
      release();
      if (!hold(value) || !in_rows()) convert(value);
    }
    check(name, shape);
    return {data_, ndim_ > 1 ? long(strides_[0] / 8) : 1};
  }
  const double* vector(nb::handle value, const char* name, long size) { return read(value, name, {size}).data; }
  int rows() const { return int(shape_[0]); }

 private:
  Py_buffer buffer_;
  bool held_ = false;
  nb::object kept_;
  const double* data_ = nullptr;
  int ndim_ = 0;
  const Py_ssize_t *shape_ = nullptr, *strides_ = nullptr;

  void take(const void* data, int ndim, const Py_ssize_t* shape, const Py_ssize_t* strides) {
    data_ = static_cast<const double*>(data);
    ndim_ = ndim;
    shape_ = shape;
    strides_ = strides;
  }
  bool lies_in_rows(nb::handle value) {
    PyArrayObject* array = doubles_of(value);
    if (!array) return false;
    take(PyArray_DATA(array), PyArray_NDIM(array), PyArray_DIMS(array), PyArray_STRIDES(array));
    if (!in_rows()) return false;
    kept_ = nb::borrow(value);
    return true;
  }
  void release() {
    if (held_) PyBuffer_Release(&buffer_);
    held_ = false;
  }
  // False: no float64.
  bool hold(nb::handle value) {
    held_ = PyObject_GetBuffer(value.ptr(), &buffer_, PyBUF_STRIDED_RO | PyBUF_FORMAT) == 0;
    if (!held_ || buffer_.itemsize != 8 || !buffer_.format || std::strcmp(buffer_.format, "d") != 0) return false;
    take(buffer_.buf, buffer_.ndim, buffer_.shape, buffer_.strides);
    return true;
  }
  void convert(nb::handle value) {
    PyErr_Clear();
    release();
    kept_ = nb::module_::import_("numpy").attr("ascontiguousarray")(value, "dtype"_a = "float64");
    if (!hold(kept_)) throw nb::python_error();
  }
  // Whether the axes but the first are packed; a vector of one axis is packed itself.
  bool in_rows() const {
    Py_ssize_t packed = 8;
    for (int axis = ndim_ - 1; axis > (ndim_ > 1 ? 0 : -1); --axis) {
      if (strides_[axis] != packed && shape_[axis] > 1) return false;
      packed *= shape_[axis];
    }
    return ndim_ < 1 || strides_[0] % 8 == 0;
  }
  void check(const char* name, std::initializer_list<long> shape) const {
    bool same = size_t(ndim_) == shape.size();
    int axis = 0;
    for (const long size : shape) {
      if (axis < ndim_) same = same && (size < 0 || shape_[axis] == size);
      ++axis;
    }
    if (same) return;
    std::vector<size_t> got, wanted;
    axis = 0;
    for (const long size : shape) {
      wanted.push_back(size_t(size < 0 && axis < ndim_ ? shape_[axis] : size));
      ++axis;
    }
    for (int i = 0; i < ndim_; ++i) got.push_back(size_t(shape_[i]));
    throw std::invalid_argument(std::string(name) + " must have shape " + shape_text(wanted) + ", got " +
                                shape_text(got));
  }
};

// A mapping's value, or nothing.
inline nb::object found_in(nb::handle mapping, nb::handle key) {
  if (PyDict_CheckExact(mapping.ptr())) return nb::borrow(PyDict_GetItemWithError(mapping.ptr(), key.ptr()));
  const nb::object value = mapping.attr("get")(key);
  return value.is_none() ? nb::object() : value;
}

inline bool same_text(nb::handle a, nb::handle b) {
  if (a.is(b)) return true;
  return PyUnicode_Check(a.ptr()) && PyUnicode_Check(b.ptr()) && PyUnicode_Compare(a.ptr(), b.ptr()) == 0;
}

}  // namespace pliant
