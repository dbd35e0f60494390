// What a solver keeps between two solves: its plan and the multipliers of its bounds, in and out.
#pragma once
#include "dense.hpp"
#include "sqp.hpp"

namespace pliant::mpc::PLIANT_ISA {
namespace {

template <class L>
Solver<L>& solver(Engine* engine) {
  return *reinterpret_cast<Solver<L>*>(engine);
}
template <class L>
const Solver<L>& solver(const Engine* engine) {
  return *reinterpret_cast<const Solver<L>*>(engine);
}

template <class L>
void set_plan(Engine* engine, const double* xs, const double* us) {
  Solver<L>& s = solver<L>(engine);
  const int N = s.options.horizon, n = s.chain.dof, nx = s.map.dim();
  for (int k = 0; xs && k <= N; ++k) s.current().x[k] = s.map.pack(xs + k * nx);
  for (int k = 0; us && k < N; ++k) s.current().u[k] = load_part(us + k * n, n, 1);
}

template <class L>
void get_plan(const Engine* engine, double* xs, double* us) {
  const Solver<L>& s = solver<L>(engine);
  const Dense<L> dense(s.map);
  const int N = s.options.horizon;
  for (int k = 0; xs && k <= N; ++k) dense.state_row(s.current().x[k], xs + k * dense.nx);
  for (int k = 0; us && k < N; ++k) dense.joint_row(s.current().u[k], us + k * dense.n);
}

template <class L>
void shift(Engine* engine) {
  Solver<L>& s = solver<L>(engine);
  const int N = s.options.horizon;
  Iterate<L>& it = s.current();
  for (int k = 0; k < N; ++k) it.x[k] = it.x[k + 1];
  for (int k = 0; k + 1 < N; ++k) it.u[k] = it.u[k + 1];
  for (int k = 0; s.options.bounds && k < N; ++k) s.multipliers[k] = s.multipliers[k + 1];
}

template <class L>
void reset(Engine* engine) {
  Solver<L>& s = solver<L>(engine);
  for (int k = 0; k < s.multipliers.count; ++k) s.multipliers[k] = BoundVector{};
}

template <class L>
void get_multipliers(const Engine* engine, double* out) {
  for (int k = 0; k < solver<L>(engine).multipliers.count; ++k, out += multipliers_per_node) {
    const BoundVector& y = solver<L>(engine).multipliers[k];
    for (int i = 0; i < max_joints; ++i) out[i] = i < lane_count ? y.torque[i] : 0;
    for (int c = 0; c < max_contact; ++c) out[max_joints + c] = y.force[c];
    for (int c = 0; c < 3; ++c) out[max_joints + max_contact + c] = y.cone[c];
  }
}

template <class L>
void set_multipliers(Engine* engine, const double* in) {
  for (int k = 0; k < solver<L>(engine).multipliers.count; ++k, in += multipliers_per_node) {
    BoundVector& y = solver<L>(engine).multipliers[k];
    for (int i = 0; i < lane_count; ++i) y.torque.set(i, in[i]);
    for (int c = 0; c < max_contact; ++c) y.force[c] = in[max_joints + c];
    for (int c = 0; c < 3; ++c) y.cone[c] = in[max_joints + max_contact + c];
  }
}

template <class L>
void tool_path(const Engine* engine, double* positions) {
  const Solver<L>& s = solver<L>(engine);
  for (int k = 0; k <= s.options.horizon; ++k, positions += 3) {
    Kinematics kin;
    forward_kinematics<L::J>(s.chain, s.current().x[k].block[0] * s.chain.is_joint, kin);
    const Vec p = frame_on_last_link<L::J>(kin, s.chain.tool_rotation, s.chain.tool_translation).p;
    positions[0] = p.x;
    positions[1] = p.y;
    positions[2] = p.z;
  }
}

}  // namespace
}  // namespace pliant::mpc::PLIANT_ISA
