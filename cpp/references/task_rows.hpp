// References of one frame as rows of numbers: moved to an anchor, and read as the parts of a signal.
#pragma once
#include <array>
#include <utility>
#include <vector>

#include "rows_ahead.hpp"

namespace pliant::references {

// Where the parts of a row begin, as `preview_rows.py` has them.
enum : npy_intp {
  kPosition = 0,
  kRotation = 3,
  kVelocity = 12,
  kAcceleration = 18,
  kWrench = 24,
  kAxes = 30,
  kNormal = 39,
  kNormalRate = 45,
  kNormalBend = 51,
  kPosture = 57,
};

// A displacement (3) m, or none.
inline const double* offset_of(nb::handle offset) {
  if (offset.is_none()) return nullptr;
  Packed<const double, 1> numbers;
  if (!numbers.look(offset) || numbers.size() != 3)
    throw std::invalid_argument("a displacement must be a vector of three float64");
  return numbers.data();
}

inline void shift(double* row, const double* offset) {
  for (int i = 0; offset && i < 3; ++i) row[kPosition + i] += offset[i];
}

// Heights of one instant, m, m/s and m/s² along the normal, on a whole row.
inline void lift(double* row, const double* height) {
  const double h = height[0], h_dot = height[1], h_ddot = height[2];
  const double *n = row + kNormal, *n_dot = row + kNormalRate, *n_ddot = row + kNormalBend;
  for (int i = 0; i < 3; ++i) row[kPosition + i] += h * n[i];
  double *velocity = row + kVelocity, *change = row + kAcceleration;
  for (int i = 0; i < 6; ++i) velocity[i] += h * n_dot[i];
  for (int i = 0; i < 6; ++i) change[i] += h * n_ddot[i];
  if (h_dot == 0.0 && h_ddot == 0.0) return;
  for (int i = 0; i < 6; ++i) velocity[i] += h_dot * n[i];
  for (int i = 0; i < 6; ++i) change[i] = change[i] + 2.0 * h_dot * n_dot[i] + h_ddot * n[i];
}

// The same on a row of a preview, which has no acceleration.
inline void lift_ahead(double* row, const double* height) {
  const double h = height[0], h_dot = height[1];
  const double *n = row + kNormal, *n_dot = row + kNormalRate;
  for (int i = 0; i < 3; ++i) row[kPosition + i] += h * n[i];
  for (int i = 0; i < 6; ++i) row[kVelocity + i] += h * n_dot[i] + h_dot * n[i];
}

inline nb::object none() { return nb::borrow(Py_None); }

// (position, rotation, velocity, acceleration, wrench, axes, posture or None) of a row that is moved; read-only.
inline nb::object parts_of(const double* row, size_t width, nb::handle offset, const std::vector<double>& height) {
  if (width < size_t(kPosture)) throw std::invalid_argument("a row of a task has 57 numbers or more");
  if (!height.empty() && height.size() != 3) throw std::invalid_argument("a height is three numbers");
  const nb::object own = new_array({npy_intp(width)});
  std::copy_n(row, width, data_of(own));
  shift(data_of(own), offset_of(offset));
  if (!height.empty()) lift(data_of(own), height.data());
  auto* array = reinterpret_cast<PyArrayObject*>(own.ptr());
  PyArray_CLEARFLAGS(array, NPY_ARRAY_WRITEABLE);
  const npy_intp three[] = {3, 3}, six[] = {6}, rest[] = {npy_intp(width) - kPosture};
  return nb::make_tuple(view_of(array, 1, three, nullptr, kPosition), view_of(array, 2, three, nullptr, kRotation),
                        view_of(array, 1, six, nullptr, kVelocity), view_of(array, 1, six, nullptr, kAcceleration),
                        view_of(array, 1, six, nullptr, kWrench), view_of(array, 2, three, nullptr, kAxes),
                        rest[0] ? view_of(array, 1, rest, nullptr, kPosture) : none());
}

// Nodes of a preview within one phase. Args: table (N+1, w) with w ≥ 57, of which rows `begin` to `end` are written;
// times (N+1) s; when the phase began; displacement; heights of all nodes, (3) or one after the other.
inline void fill(RowsAhead& rows, const Packed<double, 2>& table, size_t begin, size_t end,
                 const Packed<const double, 1>& times, double start, double period, nb::handle offset,
                 const std::vector<double>& heights) {
  const size_t count = end - begin, width = table.shape(1);
  if (begin >= end || end > table.shape(0) || times.size() != table.shape(0) || width < size_t(kPosture))
    throw std::invalid_argument("a preview has a row for each time, and a phase one of them at least");
  if (!heights.empty() && heights.size() != 3 && heights.size() != 3 * count)
    throw std::invalid_argument("a height is three numbers, one for all nodes or for each");
  const double* by = offset_of(offset);
  double* out = table.data() + begin * width;
  rows.ahead(times.data() + begin, count, start, period, out, width);
  for (size_t i = 0; i < count; ++i, out += width) {
    shift(out, by);
    if (!heights.empty()) lift_ahead(out, heights.data() + (heights.size() == 3 ? 0 : 3 * i));
  }
}

// (times, position, rotation, velocity, wrench, posture or None, axes or None) of every row of a preview; all but the
// times are views of its table.
inline nb::object columns_of(nb::handle times, nb::handle table, bool turning) {
  PyArrayObject* array = doubles_of(table);
  if (!array || PyArray_NDIM(array) != 2 || !PyArray_IS_C_CONTIGUOUS(array) || PyArray_DIMS(array)[1] < kPosture)
    throw std::invalid_argument("a table of a preview has rows of 57 numbers or more");
  const npy_intp count = PyArray_DIMS(array)[0], width = PyArray_DIMS(array)[1], rest = width - kPosture;
  const npy_intp strides[] = {8 * width, 8}, square_strides[] = {8 * width, 24, 8};
  const npy_intp three[] = {count, 3, 3}, six[] = {count, 6}, posture[] = {count, rest};
  return nb::make_tuple(times, view_of(array, 2, three, strides, kPosition),
                        view_of(array, 3, three, square_strides, kRotation), view_of(array, 2, six, strides, kVelocity),
                        view_of(array, 2, six, strides, kWrench),
                        rest ? view_of(array, 2, posture, strides, kPosture) : none(),
                        turning ? view_of(array, 3, three, square_strides, kAxes) : none());
}

// The same of a preview within one phase, at nodes (N+1) s after a time.
inline nb::object preview(RowsAhead& rows, double time, const Packed<const double, 1>& nodes, double start,
                          double period, nb::handle offset, const std::vector<double>& heights, bool turning,
                          size_t width) {
  const nb::object times = new_array({npy_intp(nodes.size())});
  for (size_t i = 0; i < nodes.size(); ++i) data_of(times)[i] = time + nodes.data()[i];
  const nb::object table = new_array({npy_intp(nodes.size()), npy_intp(width)});
  Packed<double, 2> into;
  Packed<const double, 1> at;
  if (!into.look(table) || !at.look(times)) throw std::invalid_argument("no table");
  fill(rows, into, 0, nodes.size(), at, start, period, offset, heights);
  return columns_of(times, table, turning);
}

}  // namespace pliant::references
