// The sum of half cosines on top of a base point, at an instant.
#pragma once
#include <algorithm>
#include <cmath>

#include "../shared/numpy_new.hpp"
#include "../shared/vec3.hpp"

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

// Adds the half cosines at a time in s to position, velocity and acceleration (k each). Args: pieces, each (start, s;
// duration, s; way (k); …).
inline void add_pieces(nb::handle pieces, Py_ssize_t axes, double time, double* position, double* velocity,
                       double* acceleration) {
  const Py_ssize_t count = size_of(pieces.ptr(), "the pieces");
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
}

// Position (k), velocity (width) and acceleration (width) of k ≤ width axes at a time in s; what is beyond them is
// zero. Args: base (k); pieces.
inline nb::object superposed(nb::handle base, nb::handle pieces, double time, size_t width) {
  const Py_ssize_t axes = size_of(base.ptr(), "a base");
  if (axes > Py_ssize_t(width)) throw std::invalid_argument("a row must hold every axis");
  const nb::object made = new_array({3 * npy_intp(width)});
  double *position = data_of(made), *velocity = position + width, *acceleration = velocity + width;
  std::fill_n(position, 3 * width, 0.0);
  for (Py_ssize_t axis = 0; axis < axes; ++axis) position[axis] = number_of(base.ptr(), axis);
  add_pieces(pieces, axes, time, position, velocity, acceleration);
  auto* array = reinterpret_cast<PyArrayObject*>(made.ptr());
  const npy_intp few[] = {axes}, all[] = {npy_intp(width)};
  return nb::make_tuple(view_of(array, 1, few, nullptr, 0), view_of(array, 1, all, nullptr, all[0]),
                        view_of(array, 1, all, nullptr, 2 * all[0]));
}

// Angular velocity ω = J_l(r) ṙ of a rotation vector r with rate ṙ, world axes. Source: Chirikjian, Stochastic Models,
// vol. 2, eq. 10.86.
inline Vec3 angular_velocity(const Vec3& r, const Vec3& rate) {
  const double angle = norm(r);
  const bool small = angle < 1e-4;
  const double first = small ? 0.5 : (1.0 - std::cos(angle)) / (angle * angle);
  const double second = small ? 1.0 / 6.0 : (angle - std::sin(angle)) / (angle * angle * angle);
  const Vec3 once = cross(r, rate);
  return rate + first * once + second * cross(r, once);
}

// Angular velocity (3) rad/s and acceleration (3) rad/s² of a planned rotation vector at a time in s, the latter by a
// difference over twice `step`, s. Args: base (3) rad; pieces.
inline nb::object turning(nb::handle base, nb::handle pieces, double time, double step) {
  if (size_of(base.ptr(), "a base") != 3) throw std::invalid_argument("a rotation vector has three axes");
  Vec3 found[3];
  for (int i = 0; i < 3; ++i) {
    double r[3], rate[3] = {}, bend[3] = {};
    for (int axis = 0; axis < 3; ++axis) r[axis] = number_of(base.ptr(), axis);
    add_pieces(pieces, 3, time + (i - 1) * step, r, rate, bend);
    found[i] = angular_velocity(load(r), load(rate));
  }
  const nb::object spin = new_array({3}), change = new_array({3});
  store(found[1], data_of(spin));
  const Vec3 turned = found[2] - found[0];
  store({turned.x / (2.0 * step), turned.y / (2.0 * step), turned.z / (2.0 * step)}, data_of(change));
  return nb::make_tuple(spin, change);
}

}  // namespace pliant::references
