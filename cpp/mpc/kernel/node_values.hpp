// What a node yields: the tangent dynamics in structured form and the Gauss–Newton expansion of the cost.
#pragma once
#include "../problem.hpp"
#include "layout.hpp"

namespace pliant::mpc::PLIANT_ISA {

// Rates z = (v̇, λ̇) of a node; δz = rate_x δx + rate_u δu. The step is x⁺ = E x + G z (+ the torque filter), with
// q⁺ = q + dt v + dt² v̇, v⁺ = v + dt v̇, λ⁺ = λ + dt λ̇ [FFMPC eq. 8, 24], τ⁺ = α τ + (1 − α) w [eq. 13].
template <class L>
struct alignas(64) Tangent {
  Row<L> rate_x[L::rates];
  Lanes rate_u[L::rates];  // zero for the accelerations of a layout with torques in the state
};

// Second-order expansion of a cost.
template <class L>
struct alignas(64) Expansion {
  Row<L> Lxx[L::size];  // symmetric
  Row<L> Lux[L::J];
  Lanes Luu[L::J];
  Row<L> Lx;
  Lanes Lu;
};

template <class L>
struct alignas(64) NodeValues : Tangent<L>, Expansion<L> {
  Row<L> x_next;
  Lanes acceleration;
  double cost;
  double force[max_contact], force_rate[max_contact];
  Row<L> force_x[max_contact];  // where the force is an output of the model
  Lanes force_u[max_contact];
};

// Cost ½ w r² of a residual with derivative row_x; Gauss–Newton.
template <class L>
PLIANT_INLINE void add_state_residual(NodeValues<L>& n, const Row<L>& row_x, double w, double r) {
  n.cost += 0.5 * w * r * r;
  add_scaled(n.Lx, row_x, w * r);
#pragma GCC unroll 1
  for (int k = 0; k < L::size; ++k) add_scaled(n.Lxx[k], row_x, w * row_x[k]);
}

// The same for a residual that depends on the control too.
template <class L>
PLIANT_INLINE void add_residual(NodeValues<L>& n, const Row<L>& row_x, const Lanes& row_u, double w, double r) {
  add_state_residual(n, row_x, w, r);
  n.Lu += row_u * (w * r);
#pragma GCC unroll 1
  for (int i = 0; i < L::J; ++i) {
    const double wi = w * row_u[i];
    n.Luu[i] += row_u * wi;
    add_scaled(n.Lux[i], row_x, wi);
  }
}

}  // namespace pliant::mpc::PLIANT_ISA
