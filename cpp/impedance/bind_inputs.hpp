// Inputs of a tick as Python gives them. Arrays are checked here; the core trusts them.
#pragma once
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <algorithm>
#include <string>
#include <vector>

#include "../shared/numpy_arrays.hpp"
#include "stack.hpp"

namespace pliant::impedance {

namespace nb = nanobind;

using Vector = Packed<double, 1>;
using ConstVector = Packed<const double, 1>;
using Table = Packed<double, 2>;
using ConstTable = Packed<const double, 2>;
using ConstMatrix = nb::ndarray<const double, nb::ndim<2>, nb::device::cpu>;

[[noreturn]] inline void reject(const std::string& message) { throw nb::value_error(message.c_str()); }

inline void expect(std::size_t got, int wanted, const char* name) {
  if (got != static_cast<std::size_t>(wanted)) {
    reject(std::string(name) + " must have " + std::to_string(wanted) + " entries, got " + std::to_string(got));
  }
}

inline bool finite(const double* x, int size) {
  double sum = 0.0;
  for (int i = 0; i < size; ++i) sum += x[i] * 0.0;  // 0 unless an entry is infinite or not a number
  return sum == 0.0;
}

inline void read_pose(nb::handle position, nb::handle rotation, bool needs_rotation, Pose& pose) {
  const auto p = nb::cast<ConstVector>(position);
  expect(p.shape(0), 3, "a position");
  std::copy(p.data(), p.data() + 3, pose.position);
  pose.oriented = needs_rotation && !rotation.is_none();
  if (!pose.oriented) return;
  const auto R = nb::cast<ConstMatrix>(rotation);
  if (R.shape(0) != 3 || R.shape(1) != 3) reject("a rotation must have shape (3, 3)");
  const auto row = R.stride(0), column = R.stride(1);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) pose.rotation[3 * i + j] = R.data()[i * row + j * column];
  }
}

inline bool finite(const Pose& pose) {
  return finite(pose.position, 3) && (!pose.oriented || finite(pose.rotation, 9));
}

// 0, or which input is not finite: 1 for q, 100 + i for the frame of task i, 200 + i for its reference.
inline int read_tasks(Stack& stack, nb::tuple actual, nb::tuple desired) {
  expect(actual.size(), 2 * stack.tasks(), "actual");
  expect(desired.size(), 2 * stack.tasks(), "desired");
  for (int i = 0; i < stack.tasks(); ++i) {
    TaskInput& in = stack.input()[i];
    in.retune = in.axes = nullptr;
    const bool six = stack.axes(i) == 6;
    read_pose(actual[2 * i], actual[2 * i + 1], six, in.actual);
    read_pose(desired[2 * i], desired[2 * i + 1], six, in.desired);
    if (!finite(in.actual)) return 100 + i;
    if (!finite(in.desired)) return 200 + i;
  }
  return 0;
}

// Axes of each task, row-major; `kept` holds them during the step.
inline void read_axes(Stack& stack, nb::tuple axes, std::vector<double>& kept) {
  expect(axes.size(), stack.tasks(), "axes");
  kept.resize(9 * stack.tasks());
  for (int i = 0; i < stack.tasks(); ++i) {
    if (axes[i].is_none()) continue;
    const auto R = nb::cast<ConstMatrix>(axes[i]);
    if (R.shape(0) != 3 || R.shape(1) != 3) reject("axes must have shape (3, 3)");
    for (int j = 0; j < 9; ++j) kept[9 * i + j] = R.data()[j / 3 * R.stride(0) + j % 3 * R.stride(1)];
    if (!finite(kept.data() + 9 * i, 9)) reject("axes must be finite");
    stack.input()[i].axes = kept.data() + 9 * i;
  }
}

// (n,) added to the torque, or null; `kept` keeps it alive.
inline const double* read_bias(nb::handle bias, int n, ConstVector& kept) {
  if (bias.is_none()) return nullptr;
  kept = nb::cast<ConstVector>(bias);
  expect(kept.shape(0), n, "bias");
  return kept.data();
}

// The tuple keeps the tunings alive during the step.
inline void read_changes(Stack& stack, nb::handle retune) {
  if (retune.is_none()) return;
  for (nb::handle item : nb::cast<nb::tuple>(retune)) {
    const auto pair = nb::cast<nb::tuple>(item);
    const int task = nb::cast<int>(pair[0]);
    if (task < 0 || task >= stack.tasks()) reject("there is no task " + std::to_string(task));
    const auto values = nb::cast<ConstVector>(pair[1]);
    expect(values.shape(0), 4 * stack.axes(task), "a tuning");
    stack.input()[task].retune = values.data();
  }
}

}  // namespace pliant::impedance
