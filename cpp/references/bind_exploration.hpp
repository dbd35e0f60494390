// The exploration of a frame as Python calls it.
#pragma once
#include <nanobind/stl/array.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <cmath>
#include <numeric>

#include "../shared/numpy_new.hpp"
#include "exploration/frame.hpp"

namespace pliant::references {

namespace nb = nanobind;
using namespace nb::literals;

using Vector = Packed<const double, 1>;

inline const double* numbers(const Vector& vector, size_t least) {
  if (vector.size() < least) throw std::invalid_argument("a signal of a frame has fewer numbers than it needs");
  return vector.data();
}

inline bool finite(const double* values, size_t count) {
  return std::isfinite(std::accumulate(values, values + count, 0.0));
}

// −1: a wrench or a place that is not finite; 1: the wrench is not zero; else 0.
inline int pressed(const Vector& wrench, const Vector& place) {
  const double *force = numbers(wrench, 6), *at = numbers(place, 3);
  if (!std::isfinite(std::accumulate(force, force + 6, 0.0) + std::accumulate(at, at + 3, 0.0))) return -1;
  return std::any_of(force, force + 6, [](double part) { return part != 0.0; });
}

inline void rule(Frame& frame, const std::vector<double>& linear, const std::vector<double>& angular,
                 const std::array<bool, 6>& asked, bool printed, bool normal, double resolution,
                 const std::array<double, 4>& turn) {
  frame.rules = {
      Rules::of(linear), Rules::of(angular), asked, printed, normal, resolution, {turn[0], turn[1], turn[2], turn[3]}};
}

inline void limit(Frame& frame, const std::vector<std::array<double, 3>>& limits) {
  if (limits.size() != 3 && limits.size() != 6) throw std::invalid_argument("a frame has three axes or six");
  std::vector<Limits> all;
  for (const auto& [stiffness, force_max, range] : limits) all.push_back({stiffness, force_max, range});
  frame.limit(std::move(all));
}

// (channels (6 k), x_d + Δx (3), whether it turns, whether a force was clamped)
inline nb::object explore(Frame& frame, const Vector& desired, nb::handle measured, const Vector& place,
                          const Vector& velocity, double time, double period) {
  static const double nothing[6] = {};
  const double* force = nothing;
  Vector felt;
  if (!measured.is_none()) {
    if (!felt.look(measured)) throw std::invalid_argument("a wrench must be a vector of float64");
    force = numbers(felt, 6);
  }
  const size_t count = frame.count();
  if (count == 0) throw std::invalid_argument("a frame needs the bounds of its axes first");
  const double* at = numbers(place, 3);
  if (finite(force, 6))
    frame.step(numbers(desired, 6), force, at, numbers(velocity, 3), time, period);
  else
    frame.hold();
  const nb::object channels = new_array({npy_intp(6 * count)}), moved = new_array({3});
  double* out = data_of(channels);
  bool clamped = false;
  for (size_t i = 0; i < 6; ++i) clamped = clamped || frame.axes()[i].clamped != 0.0;
  for (size_t i = 0; i < count; ++i) {
    const Axis& axis = frame.axes()[i];
    out[i] = frame.offsets()[i];
    out[count + i] = double(axis.phase);
    out[2 * count + i] = axis.stiffness;
    out[3 * count + i] = axis.reachable;
    out[4 * count + i] = axis.unreachable;
    out[5 * count + i] = axis.clamped;
  }
  const auto& by = frame.offsets();
  for (size_t i = 0; i < 3; ++i) data_of(moved)[i] = at[i] + by[i];
  return nb::make_tuple(channels, moved, by[3] != 0.0 || by[4] != 0.0 || by[5] != 0.0, clamped);
}

inline std::vector<double> clamped_of(const Frame& frame) {
  std::vector<double> found;
  for (const Axis& axis : frame.axes()) found.push_back(axis.clamped);
  return found;
}

inline void bind_exploration(nb::module_& m) {
  nb::class_<Frame>(m, "FrameCore")
      .def(nb::init<>())
      .def("rule", &rule, "linear"_a, "angular"_a, "asked"_a, "printed"_a, "normal"_a, "resolution"_a, "turn"_a)
      .def("limit", &limit, "limits"_a)
      .def("begin", &Frame::begin, "offsets"_a)
      .def("step", &explore, "desired"_a, "measured"_a.none(), "place"_a, "velocity"_a, "time"_a, "period"_a)
      .def_prop_ro("offsets", [](const Frame& frame) { return frame.offsets(); })
      .def_prop_ro("clamped", &clamped_of);
  m.def("pressed", &pressed, "wrench"_a, "place"_a);
}

}  // namespace pliant::references
