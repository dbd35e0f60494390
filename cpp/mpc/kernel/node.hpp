// One node in one pass: dynamics, cost, first derivatives, Gauss–Newton Hessian with all cross terms.
#pragma once
#include "contact.hpp"
#include "costs.hpp"

namespace pliant::mpc::PLIANT_ISA {

// Constants of the problem beside the chain.
struct ModelConstants {
  ModelData data;
  Discretisation disc;
};

// The steps below are the same for every state layout: they are compiled once per joint count and called.

// What every model shares.
template <int J>
struct alignas(64) Pass {
  Kinematics kin;
  Velocities vel;
  ToolResiduals tool;
  Dynamics dyn;
  Inverse<J> Minv;
  Lanes bias;  // h(q, v) + joint damping
};

template <int J>
[[gnu::noinline]] void begin_pass(const Chain& chain, const Stage& s, const Lanes& q, const Lanes& qd, Pass<J>& p) {
  forward_kinematics<J>(chain, q, p.kin);
  velocities<J>(p.kin, qd, p.vel);
  tool_residuals<J>(chain, p.kin, p.vel, s, p.tool);
}

template <int J>
[[gnu::noinline]] void finish_dynamics(const Chain& chain, const Lanes& qd, Pass<J>& p) {
  dynamics(chain, p.kin, p.vel, qd, p.dyn);
  MassMatrix<J> M;
  mass_matrix<J>(chain, p.kin, p.dyn, M);
  invert<J>(M, p.Minv);
  const SpatialVec none = {{0, 0, 0}, {0, 0, 0}};
  const Spatial force = transmitted(p.dyn, with_gravity(p.dyn.bias_acceleration, p.dyn), none);
  p.bias = dot(p.kin.S, force) + chain.joint_damping * qd;
}

// Semi-implicit Euler of positions and velocities [FFMPC eq. 8].
template <class L>
PLIANT_INLINE void step_joints(const Chain& chain, double dt, const Row<L>& x, const Lanes& acceleration,
                               Row<L>& next) {
  const Lanes dt_joint = chain.is_joint * dt;
  next = x;
  next.block[1] += dt_joint * acceleration;
  next.block[0] += dt_joint * x.block[1] + dt_joint * (acceleration * dt);
}

// Derivatives of the dynamics at (a, λ) and of the gravity torque under the same load.
template <int J>
struct LoadedDerivatives {
  Spatial axis_acc;
  SpatialVec last_acceleration;
  DynamicsDerivatives<J> id;
};

template <int J>
[[gnu::noinline]] void loaded_derivatives(const Chain& chain, const Pass<J>& p, const Contact& c,
                                          const SpatialVec& wrench, const Lanes& acceleration, bool loaded,
                                          LoadedDerivatives<J>& out) {
  Spatial a;
  sum_inward(p.kin.S * acceleration, a);
  a = a + p.dyn.bias_acceleration;
  out.last_acceleration = lane(a, J - 1);
  const Spatial with_weight = with_gravity(a, p.dyn);
  out.axis_acc = axis_acceleration(p.kin, p.vel, p.dyn, with_weight);
  inverse_dynamics_derivatives<J>(chain, p.kin, p.vel, p.dyn, out.axis_acc, transmitted(p.dyn, with_weight, wrench),
                                  out.id);
  if (!loaded || c.axes.turning) return;
  const AxesCorrection k = axes_correction(p.kin, c, wrench);
#pragma GCC unroll 1
  for (int i = 0; i < J; ++i) out.id.q[i] += correction_row(k, c, i);
}

// Rows of −∂(g − Jᵀλ)/∂q at constant λ.
template <int J>
[[gnu::noinline]] void load_torque_rows(const Pass<J>& p, const Contact& c, const SpatialVec& wrench, bool loaded,
                                        Lanes* rows) {
  gravity_torque_derivative<J>(p.kin, p.dyn, wrench, rows);
#pragma GCC unroll 1
  for (int i = 0; i < J; ++i) rows[i] = -rows[i];
  if (!loaded || c.axes.turning) return;
  const AxesCorrection k = axes_correction(p.kin, c, wrench);
#pragma GCC unroll 1
  for (int i = 0; i < J; ++i) rows[i] -= correction_row(k, c, i);
}

}  // namespace pliant::mpc::PLIANT_ISA
