// Signals of src/pliant/signals.py, read from C++ where they lie.
#pragma once
#include <nanobind/nanobind.h>

#include <cstring>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <vector>

#include "rows.hpp"

namespace pliant {

namespace nb = nanobind;
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
// or are no float64.
class Numbers {
 public:
  Numbers() = default;
  Numbers(const Numbers&) = delete;
  Numbers& operator=(const Numbers&) = delete;
  ~Numbers() {
    if (held_) PyBuffer_Release(&buffer_);
  }

  // Reads an array of the given shape; a first axis of -1 takes any length.
  Rows read(nb::handle value, const char* name, std::initializer_list<long> shape) {
    if (held_) PyBuffer_Release(&buffer_);
    held_ = PyObject_GetBuffer(value.ptr(), &buffer_, PyBUF_STRIDED_RO | PyBUF_FORMAT) == 0;
    if (!held_ || !in_rows()) {
      PyErr_Clear();
      if (held_) PyBuffer_Release(&buffer_);
      held_ = false;
      converted_ = nb::module_::import_("numpy").attr("ascontiguousarray")(value, "dtype"_a = "float64");
      if (PyObject_GetBuffer(converted_.ptr(), &buffer_, PyBUF_STRIDED_RO | PyBUF_FORMAT)) throw nb::python_error();
      held_ = true;
    }
    check(name, shape);
    return {static_cast<const double*>(buffer_.buf), buffer_.ndim > 1 ? long(buffer_.strides[0] / 8) : 1};
  }
  const double* vector(nb::handle value, const char* name, long size) { return read(value, name, {size}).data; }
  int rows() const { return int(buffer_.shape[0]); }

 private:
  Py_buffer buffer_{};
  bool held_ = false;
  nb::object converted_;

  // float64 whose axes but the first are packed; a vector of one axis is packed itself.
  bool in_rows() const {
    if (buffer_.itemsize != 8 || !buffer_.format || std::strcmp(buffer_.format, "d") != 0) return false;
    Py_ssize_t packed = 8;
    for (int axis = buffer_.ndim - 1; axis > (buffer_.ndim > 1 ? 0 : -1); --axis) {
      if (buffer_.strides[axis] != packed && buffer_.shape[axis] > 1) return false;
      packed *= buffer_.shape[axis];
    }
    return buffer_.ndim < 1 || buffer_.strides[0] % 8 == 0;
  }
  void check(const char* name, std::initializer_list<long> shape) const {
    std::vector<size_t> got, wanted;
    bool same = size_t(buffer_.ndim) == shape.size();
    int axis = 0;
    for (const long size : shape) {
      if (axis < buffer_.ndim) same = same && (size < 0 || buffer_.shape[axis] == size);
      wanted.push_back(size_t(size < 0 && axis < buffer_.ndim ? buffer_.shape[axis] : size));
      ++axis;
    }
    if (same) return;
    for (int i = 0; i < buffer_.ndim; ++i) got.push_back(size_t(buffer_.shape[i]));
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
