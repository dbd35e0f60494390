// Cost terms that need only the state and the kinematics [FFMPC eq. 25.1, 25.2, 25.4, 25.5] and the control's own.
#pragma once
#include "dynamics.hpp"
#include "node_values.hpp"
#include "rotation_error.hpp"
#include "stage.hpp"

namespace pliant::mpc::PLIANT_ISA {

template <class L>
PLIANT_INLINE void clear_cost(NodeValues<L>& n, const Chain& chain) {
  n.cost = 0;
  n.Lx = zero_row<L>();
  n.Lu = zero();
#pragma GCC unroll 1
  for (int k = 0; k < L::size; ++k) n.Lxx[k] = zero_row<L>();
#pragma GCC unroll 1
  for (int i = 0; i < L::J; ++i) {
    n.Lux[i] = zero_row<L>();
    n.Luu[i] = zero();
    n.Luu[i].set(i, chain.filler[i]);  // joints that are not there: keep the recursion positive definite
  }
}

// Placement and velocity of the tool: residuals r with ∂r/∂q and, for the velocity, ∂r/∂v. Translation and velocity in
// the axes of the task.
struct ToolResiduals {
  static constexpr int count = 12;  // translation, rotation, linear and angular velocity
  double value[count], weight[count];
  Lanes by_q[count], by_v[6];
};

template <int J>
PLIANT_INLINE ToolResiduals tool_residuals(const Chain& chain, const Kinematics& kin, const Velocities& vel,
                                           const Stage& s) {
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
  const Vec &wt = s.translation_weight, &wr = s.rotation_weight, &wl = s.linear_weight, &wa = s.angular_weight;
  return {{p.x, p.y, p.z, error.log.x, error.log.y, error.log.z, dv.x, dv.y, dv.z, dw.x, dw.y, dw.z},
          {wt.x, wt.y, wt.z, wr.x, wr.y, wr.z, wl.x, wl.y, wl.z, wa.x, wa.y, wa.z},
          {jacobian.lin.x, jacobian.lin.y, jacobian.lin.z, dot(turning, log_rate.row(0)), dot(turning, log_rate.row(1)),
           dot(turning, log_rate.row(2)), linear_q.x, linear_q.y, linear_q.z, angular_q.x, angular_q.y, angular_q.z},
          {jacobian.lin.x, jacobian.lin.y, jacobian.lin.z, jacobian.ang.x, jacobian.ang.y, jacobian.ang.z}};
}

template <class L>
PLIANT_INLINE void tool_cost(const ToolResiduals& r, bool derivatives, NodeValues<L>& n) {
  constexpr int J = L::J, velocity = 6;
#pragma GCC unroll 12
  for (int k = 0; k < r.count; ++k) n.cost += 0.5 * r.weight[k] * r.value[k] * r.value[k];
  if (!derivatives) return;
#pragma GCC unroll 12
  for (int k = 0; k < r.count; ++k) {
    const double slope = r.weight[k] * r.value[k];
    n.Lx.block[0] += r.by_q[k] * slope;
    if (k >= velocity) n.Lx.block[1] += r.by_v[k - velocity] * slope;
  }
#pragma GCC unroll 1
  for (int i = 0; i < J; ++i) {
    Lanes qq = zero(), qv = zero(), vq = zero(), vv = zero();
#pragma GCC unroll 6
    for (int k = 0; k < velocity; ++k) qq += r.by_q[k] * (r.weight[k] * r.by_q[k][i]);
#pragma GCC unroll 6
    for (int k = velocity; k < r.count; ++k) {
      const Lanes &by_q = r.by_q[k], &by_v = r.by_v[k - velocity];
      const double of_q = r.weight[k] * by_q[i], of_v = r.weight[k] * by_v[i];
      qq += by_q * of_q;
      qv += by_v * of_q;
      vq += by_q * of_v;
      vv += by_v * of_v;
    }
    n.Lxx[i].block[0] += qq;
    n.Lxx[i].block[1] += qv;
    n.Lxx[L::velocity + i].block[0] += vq;
    n.Lxx[L::velocity + i].block[1] += vv;
  }
}

template <class L>
PLIANT_INLINE void state_cost(const Chain& chain, const Stage& s, const Row<L>& x, bool derivatives, NodeValues<L>& n) {
  const Lanes dq = (x.block[0] - s.q_reference) * chain.is_joint, dv = (x.block[1] - s.v_reference) * chain.is_joint;
  n.cost += 0.5 * sum(s.q_weight * dq * dq + s.v_weight * dv * dv);
  if (!derivatives) return;
  n.Lx.block[0] += s.q_weight * dq;
  n.Lx.block[1] += s.v_weight * dv;
#pragma GCC unroll 1
  for (int i = 0; i < L::J; ++i) {
    n.Lxx[i].add(i, s.q_weight[i]);
    n.Lxx[L::velocity + i].add(L::velocity + i, s.v_weight[i]);
  }
}

template <class L>
PLIANT_INLINE void control_cost(const Stage& s, const Lanes& u, bool derivatives, NodeValues<L>& n) {
  const Lanes du = u - s.u_reference;
  n.cost += 0.5 * sum(s.u_weight * du * du);
  if (!derivatives) return;
  n.Lu += s.u_weight * du;
#pragma GCC unroll 1
  for (int i = 0; i < L::J; ++i) n.Luu[i].add(i, s.u_weight[i]);
}

}  // namespace pliant::mpc::PLIANT_ISA
