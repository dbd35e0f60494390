// Between dense states, as the user has them, and lanes.
#pragma once
#include "layout.hpp"

namespace pliant::mpc::PLIANT_ISA {

// Positions, velocities and extra part of a dense state, and the lanes they live in.
template <class L>
struct StateMap {
  int dof, extra;
  int dim() const { return 2 * dof + extra; }
  int lane(int i) const {
    if (i < dof) return i;
    if (i < 2 * dof) return L::velocity + i - dof;
    return L::has_torque ? L::rest + i - 2 * dof : L::force_lane(i - 2 * dof);
  }
  Row<L> pack(const double* x) const {
    Row<L> r = zero_row<L>();
    for (int i = 0; i < dim(); ++i) r.set(lane(i), x[i]);
    return r;
  }
  void unpack(const Row<L>& r, double* x) const {
    for (int i = 0; i < dim(); ++i) x[i] = r[lane(i)];
  }
};

template <class L>
PLIANT_INLINE bool finite(const Row<L>& r) {
  return isfinite(sum_magnitude(r));
}

}  // namespace pliant::mpc::PLIANT_ISA
