// Cost terms that need only the state and the kinematics [FFMPC eq. 25.1, 25.2, 25.4, 25.5] and the control's own.
#pragma once
#include "dynamics.hpp"
#include "node_values.hpp"
#include "rotation_error.hpp"
#include "stage.hpp"

namespace pliant::mpc::PLIANT_ISA {

// The expansion of the costs on the state and on the control alone, to which all others are added.
template <class L>
PLIANT_INLINE void begin_expansion(const Chain& chain, const Stage& s, const Row<L>& x, const Lanes& u,
                                   NodeValues<L>& n) {
  n.Lx = zero_row<L>();
  n.Lx.block[0] = s.q_weight * (x.block[0] - s.q_reference) * chain.is_joint;
  n.Lx.block[1] = s.v_weight * (x.block[1] - s.v_reference) * chain.is_joint;
#pragma GCC unroll 1
  for (int k = 0; k < L::size; ++k) n.Lxx[k] = zero_row<L>();
#pragma GCC unroll 1
  for (int i = 0; i < L::J; ++i) {
    n.Lxx[i].block[0] = only(i, s.q_weight);
    n.Lxx[L::velocity + i].block[1] = only(i, s.v_weight);
  }
  Lanes weight = chain.filler;  // joints that are not there: keep the recursion positive definite
  n.Lu = zero();
  if (!s.terminal) {
    weight += s.u_weight;
    n.Lu = s.u_weight * (u - s.u_reference);
  }
#pragma GCC unroll 1
  for (int i = 0; i < L::J; ++i) {
    n.Lux[i] = zero_row<L>();
    n.Luu[i] = only(i, weight);
  }
}

template <class L>
PLIANT_INLINE double state_cost(const Chain& chain, const Stage& s, const Row<L>& x) {
  const Lanes dq = (x.block[0] - s.q_reference) * chain.is_joint, dv = (x.block[1] - s.v_reference) * chain.is_joint;
  return 0.5 * sum(s.q_weight * dq * dq + s.v_weight * dv * dv);
}

PLIANT_INLINE double control_cost(const Stage& s, const Lanes& u) {
  const Lanes du = u - s.u_reference;
  return 0.5 * sum(s.u_weight * du * du);
}

// Placement and velocity of the tool: residuals r with ∂r/∂q and, for the velocity, ∂r/∂v. Translation and velocity in
// the axes of the task.
struct ToolResiduals {
  static constexpr int count = 12;  // translation, rotation, linear and angular velocity
  double value[count], weight[count];
  Lanes by_q[count];
  Spatial by_v;

  PLIANT_INLINE void set(int first, const Vec& e, const Vec& w, const Vecs& e_q) {
    value[first] = e.x;
    value[first + 1] = e.y;
    value[first + 2] = e.z;
    weight[first] = w.x;
    weight[first + 1] = w.y;
    weight[first + 2] = w.z;
    by_q[first] = e_q.x;
    by_q[first + 1] = e_q.y;
    by_q[first + 2] = e_q.z;
  }
};

template <int J>
PLIANT_INLINE void tool_residuals(const Chain& chain, const Kinematics& kin, const Velocities& vel, const Stage& s,
                                  ToolResiduals& r) {
  const Frame tool = frame_on_last_link<J>(kin, chain.tool_rotation, chain.tool_translation);
  Spatial jacobian = at_point(kin.S, tool.p);
  const SpatialVec velocity = at_point(vel.last, tool.p);
  const Spatial carried = at_point(vel.axis_rate, tool.p);
  Vecs linear_q = carried.lin + cross(jacobian.ang, velocity.lin);
  Vecs angular_q = carried.ang + cross(jacobian.ang, velocity.ang);
  const RotationError error = rotation_error(s.rotation_reference, tool.R);
  const Mat log_rate = error.jacobian * transposed(tool.R);  // ė = log_rate ω, ω in world axes
  const Vecs turning = jacobian.ang;                         // in world axes
  Vec p = tool.p - s.translation_reference;
  Vec dv = velocity.lin - s.linear_reference, dw = velocity.ang - s.angular_reference;
  if (s.turned) {
    const Mat to_task = transposed(s.task);
    p = to_task * p;
    dv = to_task * dv;
    dw = to_task * dw;
    jacobian = {to_task * jacobian.lin, to_task * jacobian.ang};
    linear_q = to_task * linear_q;
    angular_q = to_task * angular_q;
  }
  r.set(0, p, s.translation_weight, jacobian.lin);
  r.set(3, error.log, s.rotation_weight, log_rate * turning);
  r.set(6, dv, s.linear_weight, linear_q);
  r.set(9, dw, s.angular_weight, angular_q);
  r.by_v = jacobian;
}

PLIANT_INLINE double tool_cost(const ToolResiduals& r) {
  double cost = 0;
#pragma GCC unroll 12
  for (int k = 0; k < r.count; ++k) cost += 0.5 * r.weight[k] * r.value[k] * r.value[k];
  return cost;
}

template <class L>
PLIANT_INLINE void expand_tool_cost(const ToolResiduals& r, NodeValues<L>& n) {
  constexpr int velocity = 6;
  const Lanes* rows_v = &r.by_v.lin.x;               // the six of a Spatial lie one after the other
  Lanes of_q[ToolResiduals::count], of_v[velocity];  // the rows times their weights
#pragma GCC unroll 12
  for (int k = 0; k < r.count; ++k) {
    of_q[k] = r.by_q[k] * r.weight[k];
    n.Lx.block[0] += of_q[k] * r.value[k];
  }
#pragma GCC unroll 6
  for (int k = 0; k < velocity; ++k) {
    of_v[k] = rows_v[k] * r.weight[velocity + k];
    n.Lx.block[1] += of_v[k] * r.value[velocity + k];
  }
#pragma GCC unroll 1
  for (int i = 0; i < L::J; ++i) {
    Lanes qq = n.Lxx[i].block[0], qv = zero(), vq = zero(), vv = n.Lxx[L::velocity + i].block[1];
#pragma GCC unroll 6
    for (int k = 0; k < velocity; ++k) qq += r.by_q[k] * of_q[k][i];
#pragma GCC unroll 6
    for (int k = 0; k < velocity; ++k) {
      const Lanes &by_q = r.by_q[velocity + k], &by_v = rows_v[k];
      const double q = of_q[velocity + k][i], v = of_v[k][i];
      qq += by_q * q;
      qv += by_v * q;
      vq += by_q * v;
      vv += by_v * v;
    }
    n.Lxx[i].block[0] = qq;
    n.Lxx[i].block[1] = qv;
    n.Lxx[L::velocity + i].block[0] = vq;
    n.Lxx[L::velocity + i].block[1] = vv;
  }
}

}  // namespace pliant::mpc::PLIANT_ISA
