// New NumPy arrays of float64, and views of them. A module that includes this calls `import_numpy` when it is loaded.
#pragma once
#define NPY_NO_DEPRECATED_API NPY_2_0_API_VERSION
#include <numpy/arrayobject.h>

#include <initializer_list>

#include "numpy_arrays.hpp"

namespace pliant {

inline void import_numpy() {
  if (_import_array() < 0) throw nb::python_error();
}

inline double* data_of(nb::handle array) {
  return static_cast<double*>(PyArray_DATA(reinterpret_cast<PyArrayObject*>(array.ptr())));
}

// An array of this shape, its numbers not written yet.
inline nb::object new_array(std::initializer_list<npy_intp> shape) {
  nb::object made = nb::steal(PyArray_SimpleNew(int(shape.size()), const_cast<npy_intp*>(shape.begin()), NPY_DOUBLE));
  if (!made.is_valid()) throw nb::python_error();
  return made;
}

// Part of an array's numbers as an array of its own, without a copy. Args: shape and strides (bytes; null: side by
// side) of the part; where it begins.
inline nb::object view_of(PyArrayObject* of, int axes, const npy_intp* shape, const npy_intp* strides, npy_intp begin) {
  PyArray_Descr* type = PyArray_DESCR(of);
  Py_INCREF(type);
  void* data = static_cast<double*>(PyArray_DATA(of)) + begin;
  const int flags = PyArray_FLAGS(of) & NPY_ARRAY_WRITEABLE;
  nb::object made = nb::steal(
      PyArray_NewFromDescr(&PyArray_Type, type, axes, shape, const_cast<npy_intp*>(strides), data, flags, nullptr));
  if (!made.is_valid()) throw nb::python_error();
  Py_INCREF(of);
  if (PyArray_SetBaseObject(reinterpret_cast<PyArrayObject*>(made.ptr()), reinterpret_cast<PyObject*>(of)) < 0)
    throw nb::python_error();
  return made;
}

}  // namespace pliant
