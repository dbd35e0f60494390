// Dense copies of the structured results of a node, for whoever reads them from outside.
#pragma once
#include "solver.hpp"

namespace pliant::mpc::PLIANT_ISA {

template <class L>
struct Dense {
  const StateMap<L>& map;
  int nx, n;

  explicit Dense(const StateMap<L>& m) : map(m), nx(m.dim()), n(m.dof) {}
  void state_row(const Row<L>& r, double* out) const { map.unpack(r, out); }
  void joint_row(const Lanes& r, double* out) const {
    for (int i = 0; i < n; ++i) out[i] = r[i];
  }
};

template <class L>
void dense_tangent(const Solver<L>& s, const NodeValues<L>& v, double* fx, double* fu) {
  const Dense<L> dense(s.map);
  for (int i = 0; i < dense.nx; ++i) {  // row i of the tangent: the i-th unit row times it
    Row<L> unit = zero_row<L>(), by_x;
    unit.set(s.map.lane(i), 1);
    Lanes by_u;
    times_tangent<L>(unit, v, s.step, by_x, by_u);
    dense.state_row(by_x, fx + i * dense.nx);
    dense.joint_row(by_u, fu + i * dense.n);
  }
}

template <class L>
void dense_expansion(const Solver<L>& s, const NodeValues<L>& v, NodeOutput& out) {
  const Dense<L> dense(s.map);
  dense.state_row(v.Lx, out.Lx);
  dense.joint_row(v.Lu, out.Lu);
  for (int i = 0; i < dense.nx; ++i) dense.state_row(v.Lxx[s.map.lane(i)], out.Lxx + i * dense.nx);
  double row[3 * max_joints];
  for (int i = 0; i < dense.n; ++i) {
    dense.joint_row(v.Luu[i], out.Luu + i * dense.n);
    dense.state_row(v.Lux[i], row);
    for (int k = 0; k < dense.nx; ++k) out.Lxu[k * dense.n + i] = row[k];
  }
}

template <class L>
void dense_force(const Solver<L>& s, const NodeValues<L>& v, NodeOutput& out) {
  const Dense<L> dense(s.map);
  for (int c = 0; c < s.model.data.contact_dim; ++c) {
    if constexpr (L::extra == Extra::force) {
      for (int k = 0; k < dense.nx; ++k) out.force_x[c * dense.nx + k] = k == 2 * dense.n + c;
      for (int k = 0; k < dense.n; ++k) out.force_u[c * dense.n + k] = 0;
    } else {
      dense.state_row(v.force_x[c], out.force_x + c * dense.nx);
      dense.joint_row(v.force_u[c], out.force_u + c * dense.n);
    }
  }
}

}  // namespace pliant::mpc::PLIANT_ISA
