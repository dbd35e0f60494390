// The structured tangent of a step (see node_values.hpp): products with it from the left, and a step along it.
#pragma once
#include "chain.hpp"
#include "node_values.hpp"

namespace pliant::mpc::PLIANT_ISA {

// x⁺ = E x + G z (+ filter); E couples positions to velocities, G the rates to the state.
template <class L>
struct Step {
  double dt, alpha;           // alpha: of the torque filter
  Lanes dt_joint, dt2_joint;  // dt and dt² on joint lanes, zero elsewhere

  Step() = default;
  Step(const Chain& chain, double dt_, double alpha_)
      : dt(dt_), alpha(alpha_), dt_joint(chain.is_joint * dt_), dt2_joint(chain.is_joint * (dt_ * dt_)) {}
};

template <class L>
PLIANT_INLINE Row<L> times_E(const Row<L>& r, const Step<L>& s) {  // rᵀ E
  Row<L> o = r;
  o.block[1] += s.dt_joint * r.block[0];
  if constexpr (L::has_torque) o.block[2] = r.block[2] * s.alpha;
  return o;
}

template <class L>
PLIANT_INLINE void times_G(const Row<L>& r, const Step<L>& s, double* out) {  // rᵀ G, one per rate
  alignas(64) double joints[lane_count];
  store(joints, s.dt2_joint * r.block[0] + s.dt_joint * r.block[1]);
#pragma GCC unroll 8
  for (int i = 0; i < L::J; ++i) out[i] = joints[i];
#pragma GCC unroll 6
  for (int f = 0; f < L::M; ++f) out[L::J + f] = s.dt * r[L::force_lane(f)];
}

// rᵀ ∂x⁺/∂x and rᵀ ∂x⁺/∂u.
template <class L>
PLIANT_INLINE void times_tangent(const Row<L>& r, const Tangent<L>& t, const Step<L>& s, Row<L>& by_x, Lanes& by_u) {
  double g[L::rates];
  times_G(r, s, g);
  by_x = times_E(r, s);
  by_u = zero();
#pragma GCC unroll 14
  for (int j = 0; j < L::rates; ++j) {
    add_scaled(by_x, t.rate_x[j], g[j]);
    if constexpr (!L::has_torque) by_u += t.rate_u[j] * g[j];
  }
  if constexpr (L::has_torque) by_u = r.block[2] * (1 - s.alpha);
}

// δx⁺ = ∂x⁺/∂x δx + ∂x⁺/∂u δu + gap.
template <class L>
PLIANT_INLINE Row<L> propagate(const Tangent<L>& t, const Step<L>& s, const Row<L>& dx, const Lanes& du,
                               const Row<L>& gap) {
  alignas(64) double rate[lane_count + max_contact] = {};
#pragma GCC unroll 1
  for (int j = 0; j < L::rates; ++j) {
    Lanes products = t.rate_x[j].block[0] * dx.block[0];
#pragma GCC unroll 3
    for (int b = 1; b < L::blocks; ++b) products += t.rate_x[j].block[b] * dx.block[b];
    if constexpr (!L::has_torque) products += t.rate_u[j] * du;
    rate[j] = sum(products);
  }
  const Lanes acceleration = load(rate);
  Row<L> next = gap;
#pragma GCC unroll 4
  for (int b = 0; b < L::blocks; ++b) next.block[b] += dx.block[b];
  if constexpr (L::has_torque) next.block[2] += (du - dx.block[2]) * (1 - s.alpha);
  next.block[0] += s.dt_joint * dx.block[1] + s.dt2_joint * acceleration;
  next.block[1] += s.dt_joint * acceleration;
#pragma GCC unroll 6
  for (int f = 0; f < L::M; ++f) next.add(L::force_lane(f), s.dt * rate[L::J + f]);
  return next;
}

}  // namespace pliant::mpc::PLIANT_ISA
