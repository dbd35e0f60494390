// Force feedback [FFMPC section V-C]: state (q, v, λ), control τ, visco-elastic contact as dynamics of λ.
#pragma once
#include "node.hpp"
#include "sliding_friction.hpp"

namespace pliant::mpc::PLIANT_ISA {

// (M − Σ c_i J_iᵀ J_i)⁻¹ from M⁻¹, one rank at a time (Sherman–Morrison). The mean force of the exponential step
// depends on the acceleration; moved to the left side of the dynamics it acts as added inertia (c_i < 0).
template <int J>
PLIANT_INLINE void add_contact_inertia(const Contact& c, const Stage& s, int dim, Inverse<J>& Minv) {
#pragma GCC unroll 6
  for (int i = 0; i < dim; ++i) {
    const double coefficient = -s.step[i].mean_acceleration;
    const Lanes column = multiply<J>(Minv.row, c.J[i]);
    const double share = coefficient / (1 + coefficient * sum(column * c.J[i]));
#pragma GCC unroll 1
    for (int k = 0; k < J; ++k) Minv.row[k] -= column * (share * column[k]);
  }
}

// Torque about gravity under load, r = τ − (g(q) − Jᵀλ) [FFMPC eq. 25.3], with λ from the state.
template <class L>
PLIANT_INLINE void gravity_cost(const Pass<L::J>& p, const Contact& c, const Stage& s, const SpatialVec& wrench,
                                const Lanes& u, bool derivatives, NodeValues<L>& n) {
  constexpr int J = L::J;
  const Lanes residual = u - gravity_torque(p.kin, p.dyn, wrench);
  const Lanes slope = s.torque_weight * residual;
  n.cost += 0.5 * sum(slope * residual);
  if (!derivatives) return;
  Lanes rows[J];
  load_torque_rows<J>(p, c, wrench, true, rows);
  Lanes weighted[J];                          // rows times their weights
  Lanes weighted_force[L::M], cross_q[L::M];  // w J_c and its product with ∂r/∂q
#pragma GCC unroll 6
  for (int f = 0; f < L::M; ++f) {
    weighted_force[f] = s.torque_weight * c.J[f];
    cross_q[f] = zero();
  }
  n.Lu += slope;
#pragma GCC unroll 1
  for (int i = 0; i < J; ++i) {
    weighted[i] = rows[i] * s.torque_weight[i];
    n.Lx.block[0] += rows[i] * slope[i];
    n.Luu[i] += only(i, s.torque_weight);
    n.Lux[i].block[0] += weighted[i];
#pragma GCC unroll 6
    for (int f = 0; f < L::M; ++f) cross_q[f] += rows[i] * weighted_force[f][i];
  }
#pragma GCC unroll 1
  for (int k = 0; k < J; ++k) {
    Lanes qq = n.Lxx[k].block[0];
#pragma GCC unroll 8
    for (int i = 0; i < J; ++i) qq += rows[i] * weighted[i][k];
    n.Lxx[k].block[0] = qq;
  }
#pragma GCC unroll 6
  for (int f = 0; f < L::M; ++f) {
    const int lane_f = L::force_lane(f);
    n.Lx.add(lane_f, sum(c.J[f] * slope));
    n.Lxx[lane_f].block[0] += cross_q[f];
#pragma GCC unroll 1
    for (int k = 0; k < J; ++k) {
      n.Lxx[k].add(lane_f, cross_q[f][k]);
      n.Lux[k].add(lane_f, weighted_force[f][k]);
    }
#pragma GCC unroll 6
    for (int g = 0; g < L::M; ++g) n.Lxx[lane_f].add(L::force_lane(g), sum(weighted_force[f] * c.J[g]));
  }
}

// Tangent of v̇ and λ̇ [FFMPC eq. 22–23], from 0 = ∂(ID − Jᵀ λ_mean) + M δv̇ − δτ.
template <class L>
PLIANT_INLINE void force_feedback_tangent(const Pass<L::J>& p, const Contact& c, const Stage& s,
                                          LoadedDerivatives<L::J>& ld, double active, bool exponential,
                                          NodeValues<L>& n) {
  constexpr int J = L::J, M = L::M;
  ContactDerivatives cd;
  contact_derivatives(p.kin, p.vel, p.dyn, c, ld.axis_acc, ld.last_acceleration, M, cd);
  DynamicsDerivatives<J>& id = ld.id;
  if (exponential) {
#pragma GCC unroll 6
    for (int f = 0; f < M; ++f) {
      const ForceStep& k = s.step[f];
      const Lanes mean_q = (cd.speed_q[f] * k.mean_velocity + cd.acceleration_q[f] * k.mean_acceleration) * active;
      const Lanes mean_v = (c.J[f] * k.mean_velocity + cd.acceleration_v[f] * k.mean_acceleration) * active;
#pragma GCC unroll 1
      for (int i = 0; i < J; ++i) {
        id.q[i] -= mean_q * c.J[f][i];
        id.v[i] -= mean_v * c.J[f][i];
      }
    }
  }
  Lanes by_force[M];  // M⁻¹ Jᵀ columns
#pragma GCC unroll 6
  for (int f = 0; f < M; ++f) by_force[f] = multiply<J>(p.Minv.row, c.J[f]) * (1 + s.step[f].mean_force);
#pragma GCC unroll 1
  for (int i = 0; i < J; ++i) {
    Lanes by_q = zero(), by_v = zero();
#pragma GCC unroll 8
    for (int k = 0; k < J; ++k) {
      const double m = p.Minv.row[i][k];
      by_q -= id.q[k] * m;
      by_v -= id.v[k] * m;
    }
    n.rate_x[i] = zero_row<L>();
    n.rate_x[i].block[0] = by_q;
    n.rate_x[i].block[1] = by_v;
#pragma GCC unroll 6
    for (int f = 0; f < M; ++f) n.rate_x[i].set(L::force_lane(f), by_force[f][i]);
    n.rate_u[i] = p.Minv.row[i];
  }
#pragma GCC unroll 6
  for (int f = 0; f < M; ++f) {  // λ̇ = −velocity ẋ − acceleration ẍ − force λ
    const ForceStep& k = s.step[f];
    Lanes by_q = cd.acceleration_q[f], by_v = cd.acceleration_v[f], by_u = zero();
#pragma GCC unroll 8
    for (int i = 0; i < J; ++i) {
      by_q += n.rate_x[i].block[0] * c.J[f][i];
      by_v += n.rate_x[i].block[1] * c.J[f][i];
      by_u += n.rate_u[i] * c.J[f][i];
    }
    Row<L>& row = n.rate_x[J + f];
    row = zero_row<L>();
    row.block[0] = cd.speed_q[f] * (-k.velocity * active) - by_q * (k.acceleration * active);
    row.block[1] = c.J[f] * (-k.velocity * active) - by_v * (k.acceleration * active);
#pragma GCC unroll 6
    for (int g = 0; g < M; ++g)
      row.set(L::force_lane(g), (-k.acceleration * sum(c.J[f] * by_force[g]) - (f == g ? k.force : 0)) * active);
    n.rate_u[J + f] = by_u * (-k.acceleration * active);
  }
}

template <class L>
PLIANT_INLINE void force_cost(const Stage& s, const Row<L>& x, bool derivatives, NodeValues<L>& n) {
#pragma GCC unroll 6
  for (int f = 0; f < L::M; ++f) {  // [FFMPC eq. 21]
    const int lane_f = L::force_lane(f);
    const double error = x[lane_f] - s.force_reference[f], slope = s.force_weight[f] * error;
    n.force[f] = x[lane_f];
    n.cost += 0.5 * slope * error;
    if (!derivatives) continue;
    n.Lx.add(lane_f, slope);
    n.Lxx[lane_f].add(lane_f, s.force_weight[f]);
  }
}

template <class L>
[[gnu::noinline]] void force_feedback_node(const Chain& chain, const ModelConstants& model, const Stage& s,
                                           const Row<L>& x, const Lanes& u, bool derivatives, NodeValues<L>& n) {
  constexpr int J = L::J, M = L::M;
  const Lanes q = x.block[0] * chain.is_joint, qd = x.block[1] * chain.is_joint;
  Pass<J> p;
  begin_pass<J>(chain, s, q, qd, p);
  n.cost = tool_cost(p.tool) + state_cost(chain, s, x);
  if (derivatives) {
    begin_expansion(chain, s, x, u, n);
    expand_tool_cost(p.tool, n);
  }
  force_cost(s, x, derivatives, n);
  if (s.terminal) return;
  n.cost += control_cost(s, u);
  finish_dynamics<J>(chain, qd, p);

  const double active = s.active ? 1 : 0;
  const bool exponential = model.disc.exponential;
  Contact c;
  make_contact<J>(chain, model.data, s.task, p.kin, p.vel, p.dyn, M, c);
  double force[M], mean_force[M];
#pragma GCC unroll 6
  for (int f = 0; f < M; ++f) {
    const ForceStep& k = s.step[f];
    c.J[f] = c.J[f] * active;  // contact off: the robot does not feel λ, and λ̇ = 0
    force[f] = x[L::force_lane(f)] * active;
    mean_force[f] =
        (1 + k.mean_force) * force[f] + (k.mean_velocity * c.speed[f] + k.mean_acceleration * c.drift[f]) * active;
  }
  if (exponential) add_contact_inertia<J>(c, s, M, p.Minv);
  Lanes drive = (u - p.bias) * chain.is_joint;
#pragma GCC unroll 6
  for (int f = 0; f < M; ++f) drive += c.J[f] * mean_force[f];
  n.acceleration = multiply<J>(p.Minv.row, drive);
  step_joints(chain, s.dt, x, n.acceleration, n.x_next);
#pragma GCC unroll 6
  for (int f = 0; f < M; ++f) {  // [FFMPC eq. 18]
    const ForceStep& k = s.step[f];
    const double drift = sum(c.J[f] * n.acceleration), acceleration = drift + c.drift[f];
    mean_force[f] += k.mean_acceleration * drift;
    n.force_rate[f] = -active * (k.velocity * c.speed[f] + k.acceleration * acceleration + k.force * force[f]);
  }
  [[maybe_unused]] SlidingRate slide;
  if constexpr (M >= 3) {
    if (s.slides) {
      sliding_rate(s, n.force_rate, force, slide);
      for (int f = 0; f < 2; ++f) n.force_rate[f] = slide.rate[f];
    }
  }
#pragma GCC unroll 6
  for (int f = 0; f < M; ++f) {
    n.x_next.add(L::force_lane(f), s.dt * n.force_rate[f]);
    n.cost += 0.5 * s.force_rate_weight[f] * n.force_rate[f] * n.force_rate[f];
  }
  const SpatialVec load = contact_wrench(c, force, M);
  gravity_cost(p, c, s, load, u, derivatives, n);
  if (!derivatives) return;

  LoadedDerivatives<J> ld;
  loaded_derivatives<J>(chain, p, c, contact_wrench(c, mean_force, M), n.acceleration, s.active, ld);
  force_feedback_tangent(p, c, s, ld, active, exponential, n);
  if constexpr (M >= 3) {
    if (s.slides) apply_sliding_tangent(slide, n);
  }
  const double cost = n.cost;
#pragma GCC unroll 6
  for (int f = 0; f < M; ++f)
    add_residual(n, n.rate_x[J + f], n.rate_u[J + f], s.force_rate_weight[f], n.force_rate[f]);
  n.cost = cost;  // the force rate was counted above
}

}  // namespace pliant::mpc::PLIANT_ISA
