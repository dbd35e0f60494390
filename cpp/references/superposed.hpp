// The sum of half cosines on top of a base point, at an instant.
#pragma once
#include <algorithm>
#include <cmath>

#include "../shared/numpy_new.hpp"

namespace pliant::references {

namespace nb = nanobind;

inline constexpr double kPi = 3.14159265358979323846;

inline double number_of(PyObject* tuple, Py_ssize_t place) {
  const double value = PyFloat_AsDouble(PyTuple_GET_ITEM(tuple, place));
  if (value == -1.0 && PyErr_Occurred()) throw nb::python_error();
  return value;
}

inline Py_ssize_t size_of(PyObject* value, const char* what) {
  if (!PyTuple_Check(value)) throw std::invalid_argument(std::string(what) + " must be a tuple");
  return PyTuple_GET_SIZE(value);
}

// Position (k), velocity (width) and acceleration (width) of k ≤ width axes at a time in s; what is beyond them is
// zero. Args: base (k); pieces, each (start, s; duration, s; way (k); …).
inline nb::object superposed(nb::handle base, nb::handle pieces, double time, size_t width) {
  const Py_ssize_t axes = size_of(base.ptr(), "a base"), count = size_of(pieces.ptr(), "the pieces");
  if (axes > Py_ssize_t(width)) throw std::invalid_argument("a row must hold every axis");
  const nb::object made = new_array({3 * npy_intp(width)});
  double *position = data_of(made), *velocity = position + width, *acceleration = velocity + width;
  std::fill_n(position, 3 * width, 0.0);
  for (Py_ssize_t axis = 0; axis < axes; ++axis) position[axis] = number_of(base.ptr(), axis);
  for (Py_ssize_t i = 0; i < count; ++i) {
    PyObject* piece = PyTuple_GET_ITEM(pieces.ptr(), i);
    if (size_of(piece, "a piece") < 3) throw std::invalid_argument("a piece has a start, a duration and a way");
    PyObject* way = PyTuple_GET_ITEM(piece, 2);
    if (size_of(way, "a way") != axes) throw std::invalid_argument("a way has the axes of its base");
    const double start = number_of(piece, 0), duration = number_of(piece, 1);
    if (time <= start) continue;
    const double angle = kPi * std::min((time - start) / duration, 1.0);
    const double rate = angle < kPi ? kPi / duration : 0.0;
    const double cosine = std::cos(angle), share = 0.5 * (1.0 - cosine);
    const double speed = 0.5 * rate * std::sin(angle), push = 0.5 * rate * rate * cosine;
    for (Py_ssize_t axis = 0; axis < axes; ++axis) {
      const double length = number_of(way, axis);
      position[axis] += share * length;
      velocity[axis] += speed * length;
      acceleration[axis] += push * length;
    }
  }
  auto* array = reinterpret_cast<PyArrayObject*>(made.ptr());
  const npy_intp few[] = {axes}, all[] = {npy_intp(width)};
  return nb::make_tuple(view_of(array, 1, few, nullptr, 0), view_of(array, 1, all, nullptr, all[0]),
                        view_of(array, 1, all, nullptr, 2 * all[0]));
}

}  // namespace pliant::references
