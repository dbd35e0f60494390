// Models whose contact force is an output, not a state: rigid contact (classical, torque feedback; [FFMPC sections
// III-C, IV-C]), the naive visco-elastic contact (section V-B), and free motion.
#pragma once
#include "output_force_law.hpp"

namespace pliant::mpc::PLIANT_ISA {

// One row over the state from its parts over q, v and τ; τ is the state's or the control's.
template <class L>
PLIANT_INLINE void set_row(const Lanes& by_q, const Lanes& by_v, const Lanes& by_torque, Row<L>& row_x, Lanes& row_u) {
  row_x.block[0] = by_q;
  row_x.block[1] = by_v;
  if constexpr (L::has_torque) {
    row_x.block[2] = by_torque;
    row_u = zero();
  } else {
    row_u = by_torque;
  }
}

template <class L>
PLIANT_INLINE void output_force_tangent(const ModelData& model, const Stage& s, const LoadedDerivatives<L::J>& ld,
                                        OutputPass<L::J>& o, NodeValues<L>& n) {
  constexpr int J = L::J;
  const Pass<J>& p = o.pass;
  Lanes a_q[J], a_v[J], a_torque[J];
#pragma GCC unroll 1
  for (int i = 0; i < J; ++i) {
    a_q[i] = zero();
    a_v[i] = zero();
    a_torque[i] = p.Minv.row[i];
#pragma GCC unroll 8
    for (int k = 0; k < J; ++k) {
      a_q[i] -= ld.id.q[k] * p.Minv.row[i][k];
      a_v[i] -= ld.id.v[k] * p.Minv.row[i][k];
    }
  }
  if (o.dim > 0) {
    ContactDerivatives cd;
    contact_derivatives(p.kin, p.vel, p.dyn, o.contact, ld.axis_acc, ld.last_acceleration, o.dim, cd);
    if (o.rigid)
      rigid_force_derivatives<J>(model, cd, a_q, a_v, o);
    else
      visco_elastic_force_derivatives<J>(s, cd, o);
  }
  for (int f = 0; f < o.dim; ++f) {
#pragma GCC unroll 1
    for (int i = 0; i < J; ++i) {  // v̇ feels λ through M⁻¹ Jᵀ
      const double share = o.JMinv[f][i];
      a_q[i] += o.force.by_q[f] * share;
      a_v[i] += o.force.by_v[f] * share;
      a_torque[i] += o.force.by_torque[f] * share;
    }
    set_row<L>(o.force.by_q[f], o.force.by_v[f], o.force.by_torque[f], n.force_x[f], n.force_u[f]);
  }
#pragma GCC unroll 1
  for (int i = 0; i < J; ++i) set_row<L>(a_q[i], a_v[i], a_torque[i], n.rate_x[i], n.rate_u[i]);
}

// Joint i's pair r_τ = τ_i + c(x), r_w = w_i + c(x), c with derivative row_x: one outer product and the rows of τ_i,
// w_i.
template <class L>
PLIANT_INLINE void add_filtered_residuals(NodeValues<L>& n, int i, const Row<L>& row_x, double weight, double residual,
                                          double weight_w, double residual_w) {
  const int lane_torque = L::rest + i;
  const double both = weight + weight_w;
  add_scaled(n.Lx, row_x, weight * residual + weight_w * residual_w);
  n.Lx.add(lane_torque, weight * residual);
  n.Lu.add(i, weight_w * residual_w);
  n.Luu[i].add(i, weight_w);
  add_scaled(n.Lux[i], row_x, weight_w);
#pragma GCC unroll 1
  for (int k = 0; k < L::size; ++k) {
    add_scaled(n.Lxx[k], row_x, both * row_x[k]);
    n.Lxx[k].add(lane_torque, weight * row_x[k]);
  }
  add_scaled(n.Lxx[lane_torque], row_x, weight);
  n.Lxx[lane_torque].add(lane_torque, weight);
}

// Torque about gravity under load: r = τ − (g(q) − Jᵀλ) and, with a torque filter, r_w = w − (g(q) − Jᵀλ)
// [FFMPC eq. 25.3, 28], where λ = λ(x, u).
template <class L>
PLIANT_INLINE void gravity_cost(const OutputPass<L::J>& o, const Stage& s, const SpatialVec& wrench,
                                const Lanes& torque, const Lanes& u, bool derivatives, NodeValues<L>& n) {
  constexpr int J = L::J;
  const Pass<J>& p = o.pass;
  const Lanes load = gravity_torque(p.kin, p.dyn, wrench);
  const Lanes residual = torque - load, residual_w = u - load;
  n.cost += 0.5 * sum(s.torque_weight * residual * residual);
  if (L::has_torque) n.cost += 0.5 * sum(s.control_weight * residual_w * residual_w);
  if (!derivatives) return;
  Lanes rows[J];
  load_torque_rows<J>(p, o.contact, wrench, o.dim > 0, rows);
  const double cost = n.cost;
#pragma GCC unroll 1
  for (int i = 0; i < J; ++i) {
    Lanes by_q = rows[i], by_v = zero(), by_torque = zero();
    for (int f = 0; f < o.dim; ++f) {
      by_q += o.force.by_q[f] * o.contact.J[f][i];
      by_v += o.force.by_v[f] * o.contact.J[f][i];
      by_torque += o.force.by_torque[f] * o.contact.J[f][i];
    }
    Row<L> row_x;
    Lanes row_u;
    if constexpr (L::has_torque) {
      set_row<L>(by_q, by_v, by_torque, row_x, row_u);
      add_filtered_residuals(n, i, row_x, s.torque_weight[i], residual[i], s.control_weight[i], residual_w[i]);
    } else {
      by_torque.add(i, 1);
      set_row<L>(by_q, by_v, by_torque, row_x, row_u);
      add_residual(n, row_x, row_u, s.torque_weight[i], residual[i]);
    }
  }
  n.cost = cost;
}

template <class L>
PLIANT_INLINE void output_force_cost(const OutputPass<L::J>& o, const Stage& s, bool derivatives, NodeValues<L>& n) {
  for (int f = 0; f < o.dim; ++f) {  // [FFMPC eq. 7, 12]
    const double error = n.force[f] - s.force_reference[f], w = s.force_weight[f];
    if (!derivatives)
      n.cost += 0.5 * w * error * error;
    else if constexpr (L::has_torque)
      add_state_residual(n, n.force_x[f], w, error);
    else
      add_residual(n, n.force_x[f], n.force_u[f], w, error);
  }
}

// q, v by eq. 8; τ⁺ = α τ + (1 − α) w by eq. 13.
template <class L>
PLIANT_INLINE void step_output_force(const Chain& chain, const Discretisation& disc, const Row<L>& x, const Lanes& u,
                                     NodeValues<L>& n) {
  step_joints(chain, disc.dt, x, n.acceleration, n.x_next);
  if constexpr (L::has_torque) n.x_next.block[2] = x.block[2] * disc.alpha + u * (1 - disc.alpha);
}

template <class L>
[[gnu::noinline]] void output_force_node(const Chain& chain, const ModelConstants& model, const Stage& s,
                                         const Row<L>& x, const Lanes& u, bool derivatives, NodeValues<L>& n) {
  constexpr int J = L::J;
  const Lanes q = x.block[0] * chain.is_joint, qd = x.block[1] * chain.is_joint;
  OutputPass<J> o;
  Pass<J>& p = o.pass;
  begin_pass<J>(chain, s, q, qd, p);
  n.cost = tool_cost(p.tool) + state_cost(chain, s, x);
  if (derivatives) {
    begin_expansion(chain, s, x, u, n);
    expand_tool_cost(p.tool, n);
  }
  if (s.terminal) return;
  n.cost += control_cost(s, u);
  finish_dynamics<J>(chain, qd, p);

  Lanes torque = u;
  if constexpr (L::has_torque) torque = x.block[2];
  torque = torque * chain.is_joint;
  o.dim = s.active ? model.data.contact_dim : 0;
  o.rigid = model.data.kind != Kind::naive_viscoelastic;
  make_contact<J>(chain, model.data, s.task, p.kin, p.vel, p.dyn, o.dim, o.contact);
  deflection<J>(chain, p.kin, o.contact, s, o.dim, o.deflection, o.deflection_q);
  n.acceleration = multiply<J>(p.Minv.row, torque - p.bias);  // free motion
  if (o.rigid)
    rigid_force<J>(model.data, n.acceleration, o);
  else
    visco_elastic_force<J>(s, o);
  Lanes contact_torque = zero();
  for (int f = 0; f < o.dim; ++f) contact_torque += o.contact.J[f] * o.force.value[f];
  n.acceleration += multiply<J>(p.Minv.row, contact_torque);
  for (int f = 0; f < model.data.contact_dim; ++f) {
    n.force[f] = f < o.dim ? o.force.value[f] : 0;
    n.force_rate[f] = 0;
  }
  step_output_force(chain, model.disc, x, u, n);
  const SpatialVec wrench = contact_wrench(o.contact, o.force.value, o.dim);
  if (derivatives) {
    for (int f = 0; f < model.data.contact_dim; ++f) {
      n.force_x[f] = zero_row<L>();
      n.force_u[f] = zero();
    }
    LoadedDerivatives<J> ld;
    loaded_derivatives<J>(chain, p, o.contact, wrench, n.acceleration, o.dim > 0, ld);
    output_force_tangent(model.data, s, ld, o, n);
  }
  gravity_cost<L>(o, s, wrench, torque, u, derivatives, n);
  output_force_cost(o, s, derivatives, n);
}

}  // namespace pliant::mpc::PLIANT_ISA
