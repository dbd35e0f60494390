// How far to go along a semismooth Newton direction of the augmented Lagrangian (bounds.hpp).
//
// Along a segment between two directions that both satisfy the linear dynamics, the cost is a parabola and each term is
// convex and once differentiable, so the best length is the root of an increasing function. Without it the active set
// can go round for ever: with torque bounds and a cone together does in most problems. QPALM searches the same way.
#pragma once
#include "bounds.hpp"

namespace pliant::mpc::PLIANT_ISA {

// Torque and force of a stage, linearised at a direction.
struct alignas(64) BoundValues {
  Lanes torque;
  double force[max_contact];
};

// Slope of a stage's quadratic cost along (step_x, step_u) at (dx, du); the regularisation belongs to it.
template <class L>
inline double cost_slope(const Expansion<L>& e, double regularisation, const Row<L>& dx, const Lanes& du,
                         const Row<L>& step_x, const Lanes& step_u) {
  Row<L> by_x = e.Lx;
  Lanes by_u = e.Lu + du * regularisation;
  add_scaled(by_x, dx, regularisation);
  for (int i = 0; i < L::size; ++i) add_scaled(by_x, e.Lxx[i], dx[i]);
  for (int i = 0; i < L::J; ++i) {
    by_u += e.Luu[i] * du[i];
    by_u.add(i, dot(e.Lux[i], dx));
    add_scaled(by_x, e.Lux[i], du[i]);
  }
  return dot(by_x, step_x) + sum(by_u * step_u);
}

// Slope of a stage's terms at a share of the way from one set of values to another.
inline double term_slope(const StageBounds& b, const BoundVector& y, const BoundValues& from, const BoundValues& to,
                         double share) {
  BoundTerms at;
  double force[max_contact];
  const int rows = b.cone ? larger(b.forces, 3) : b.forces;
  for (int c = 0; c < rows; ++c) force[c] = from.force[c] + share * (to.force[c] - from.force[c]);
  const Lanes way = to.torque - from.torque;
  bound_terms(b, y, from.torque + way * share, force, at);
  double slope = b.torque ? sum(at.gradient.torque * way) : 0;
  for (int c = 0; c < b.forces; ++c) slope += at.gradient.force[c] * (to.force[c] - from.force[c]);
  for (int c = 0; c < 3 && b.cone; ++c) slope += at.gradient.cone[c] * (to.force[c] - from.force[c]);
  return slope;
}

// Share in (0, 1] at which an increasing slope, negative at 0, is zero; 1 if it is not positive there.
template <class Slope>
double best_share(const Slope& slope) {
  if (slope(1.0) <= 0) return 1;
  double low = 0, high = 1;
  for (int i = 0; i < 30; ++i) {
    const double middle = 0.5 * (low + high);
    (slope(middle) > 0 ? high : low) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace pliant::mpc::PLIANT_ISA
