// Where the parts of the state lie in the lanes.
#pragma once
#include "simd.hpp"

namespace pliant::mpc::PLIANT_ISA {

enum class Extra { none, force, torque };

// Blocks of lanes (8, or 4): positions, velocities, the rest. With one joint less than lanes, the last lane of the
// first two blocks is free and takes a force component: a one-dimensional contact then needs two blocks instead of
// three.
template <int J_, Extra extra_, int M_>
struct Layout {
  static constexpr int J = J_;  // joints, filled up
  static constexpr Extra extra = extra_;
  static constexpr int M = extra_ == Extra::force ? M_ : 0;  // force components in the state
  static constexpr bool has_torque = extra_ == Extra::torque;
  static constexpr int velocity = lane_count, rest = 2 * lane_count;            // first lanes of the parts
  static constexpr int packed = J < lane_count && M > 0 ? (M < 2 ? M : 2) : 0;  // components in the free lanes
  static constexpr int blocks = 2 + (has_torque ? 1 : (M - packed + lane_count - 1) / lane_count);
  static constexpr int size = has_torque   ? rest + J
                              : M > packed ? rest + M - packed
                                           : velocity + J + (packed > 1 ? 1 : 0);
  static constexpr int rates = J + M;  // accelerations and force rates

  static constexpr int force_lane(int c) { return c < packed ? J + lane_count * c : rest + c - packed; }
  static constexpr bool used(int lane) {
    if (lane < rest && lane % lane_count < J) return true;
    if (has_torque && lane >= rest) return lane - rest < J;
    for (int c = 0; c < M; ++c)
      if (force_lane(c) == lane) return true;
    return false;
  }
};

// Free lanes when no force is packed there: rows that stay zero.
template <class L>
PLIANT_INLINE bool idle(int lane) {
  constexpr int first = lane_count - 1, second = 2 * lane_count - 1;
  constexpr bool idle_first = !L::used(first), idle_second = !L::used(second);
  return (idle_first && lane == first) || (idle_second && lane == second);
}

// One number per state component.
template <class L>
struct alignas(64) Row {
  Lanes block[L::blocks];

  PLIANT_INLINE double operator[](int i) const { return reinterpret_cast<const double*>(block)[i]; }
  PLIANT_INLINE void set(int i, double value) { reinterpret_cast<double*>(block)[i] = value; }
  PLIANT_INLINE void add(int i, double value) { reinterpret_cast<double*>(block)[i] += value; }
};

template <class L>
PLIANT_INLINE Row<L> zero_row() {
  Row<L> r;
#pragma GCC unroll 4
  for (int b = 0; b < L::blocks; ++b) r.block[b] = zero();
  return r;
}
template <class L>
PLIANT_INLINE void add_scaled(Row<L>& r, const Row<L>& a, double s) {  // r += s a
#pragma GCC unroll 4
  for (int b = 0; b < L::blocks; ++b) r.block[b] += a.block[b] * s;
}
template <class L>
PLIANT_INLINE void scale(Row<L>& r, double s) {
#pragma GCC unroll 4
  for (int b = 0; b < L::blocks; ++b) r.block[b] = r.block[b] * s;
}
template <class L>
PLIANT_INLINE double dot(const Row<L>& a, const Row<L>& b) {
  Lanes s = a.block[0] * b.block[0];
#pragma GCC unroll 3
  for (int i = 1; i < L::blocks; ++i) s += a.block[i] * b.block[i];
  return sum(s);
}
template <class L>
PLIANT_INLINE double largest_magnitude(const Row<L>& a) {
  Lanes m = absolute(a.block[0]);
#pragma GCC unroll 3
  for (int i = 1; i < L::blocks; ++i) m = larger(m, absolute(a.block[i]));
  return largest(m);
}
template <class L>
PLIANT_INLINE double sum_magnitude(const Row<L>& a) {
  Lanes s = absolute(a.block[0]);
#pragma GCC unroll 3
  for (int i = 1; i < L::blocks; ++i) s += absolute(a.block[i]);
  return sum(s);
}

}  // namespace pliant::mpc::PLIANT_ISA
