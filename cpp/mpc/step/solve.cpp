// The part of a step that solves: references and parameters into the nodes, the solver, its solution into the plan.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "../validate.hpp"
#include "controller.hpp"
#include "prediction.hpp"

namespace pliant::mpc::step {
namespace {

constexpr double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
constexpr double force_rounding = 1e-6;  // [N] a force turned to other axes may point into the surface by as much

template <int count>
void copy(double (&to)[count], const double* from) {
  std::memcpy(to, from, sizeof to);
}

double along(const double* a, const double* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

bool all_finite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

void copy_weights(const NodeData& from, NodeData& to) {
  copy(to.state_weight, from.state_weight);
  copy(to.control_weight, from.control_weight);
  copy(to.torque_gravity_weight, from.torque_gravity_weight);
  copy(to.control_gravity_weight, from.control_gravity_weight);
  copy(to.translation_weight, from.translation_weight);
  copy(to.rotation_weight, from.rotation_weight);
  copy(to.velocity_weight, from.velocity_weight);
  copy(to.force_weight, from.force_weight);
  copy(to.force_rate_weight, from.force_rate_weight);
}

}  // namespace

Refusal Controller::solve(const Estimated& e, const Wanted& w, const double* measured, const double* R_world_task,
                          State& state) const {
  const Settings& s = settings_;
  Memory& memory = state.memory;
  if (!measured) {
    ++memory.failures;
    memory.report = {};
    memory.report.status = Status::nan;
    memory.deadline_missed = false;
    memory.contact_nodes = 0;
    std::fill(state.series.path.begin(), state.series.path.end(), 0.0);
    std::fill(state.series.forces.begin(), state.series.forces.end(), 0.0);
    return {};
  }
  if (const Fault fault = along_horizon(s, w, state.horizon); fault != Fault::none) return {fault};
  if (s.model.axes != Axes::local)  // whose normal turns with the tool, and may be any of its axes
    if (const Refusal refusal = require_pushing(state); refusal.fault != Fault::none) return refusal;
  integrate(e, w, state);
  shift_forces(state);
  write_environment(e, state);
  if (s.model.axes == Axes::surface) copy(memory.contact.task_rotation, contact_axes(s, nullptr, R_world_task));
  double x[3 * max_joints];
  std::copy(measured, measured + s.nx(), x);
  // a contact that is rigid needs a phase that has it, too
  const bool felt = e.contact < 0 ? memory.touching : e.contact;
  roll_ahead(s, felt && (memory.touching || s.force_state()), state, x);
  if (const Refusal refusal = write_phases(e, state); refusal.fault != Fault::none) return refusal;
  write_references(state);
  write_anchor(x, state);
  for (int k = 0; k <= s.N(); ++k) validate(state.series.nodes[size_t(k)], k, s.n(), s.model, s.options.dt);
  const KernelTable& table = *state.solver.table;
  const NodeData* nodes = state.series.nodes.data();
  if (!memory.has_plan || memory.failures) {
    table.reset(state.solver.engine);
    table.quasi_static(state.solver.engine, nodes, x);
  } else if (e.time - memory.plan_time > 0.5 * s.options.dt) {
    table.shift(state.solver.engine);
  }
  table.solve(state.solver.engine, nodes, x, s.limits, memory.report);
  keep_solution(e, state);
  return {};
}

// A contact can only push.
Refusal Controller::require_pushing(const State& state) const {
  Refusal worst;
  for (size_t k = 0; k < state.horizon.nodes.size(); ++k) {
    double normal[3];
    normal_of(settings_, state.horizon.turning ? state.horizon.nodes[k].task_rotation : nullptr, normal);
    const double pushes = along(state.horizon.nodes[k].wrench, normal);
    if (pushes >= -force_rounding || (worst.fault != Fault::none && pushes >= worst.value)) continue;
    worst.fault = Fault::pulls;
    worst.node = int(k);
    worst.value = pushes;
    std::copy(normal, normal + 3, worst.normal);
  }
  return worst;
}

// Moves the force shift on from one solve to the next; without contact it starts anew.
void Controller::integrate(const Estimated& e, const Wanted& w, State& state) const {
  const Compensations& c = settings_.compensation;
  if (c.force_integral == 0 || !e.wrench || !w.has_any) return;
  if (!(state.memory.touching && e.contact == 1)) {
    state.memory.force_shift = 0;
    return;
  }
  double normal[3];
  normal_of(settings_, w.first.task_rotation, normal);
  const double missing[3] = {w.first.wrench[0] - e.wrench[0], w.first.wrench[1] - e.wrench[1],
                             w.first.wrench[2] - e.wrench[2]};
  const double error = along(normal, missing);
  if (!std::isfinite(error)) return;
  const double shift = state.memory.force_shift + c.force_integral * settings_.period * error;
  state.memory.force_shift = std::min(std::max(shift, -c.force_shift_max), c.force_shift_max);
}

// Forces along the normal, at the nodes at which there is to be one.
void Controller::shift_forces(State& state) const {
  if (state.memory.force_shift == 0) return;
  for (NodeReference& node : state.horizon.nodes) {
    double normal[3];
    normal_of(settings_, state.horizon.turning ? node.task_rotation : nullptr, normal);
    if (!(along(node.wrench, normal) > 0)) continue;
    for (int i = 0; i < 3; ++i) node.wrench[i] += state.memory.force_shift * normal[i];
  }
}

// Lets the estimated stiffness along the normal, as far as the integrator bears it, replace the assumed one, and the
// damping, where its uncertainty and what a force that is one period old does to it (K dt) are at most a fifth of it.
void Controller::write_environment(const Estimated& e, State& state) const {
  if (!settings_.compensation.environment || settings_.m() == 0) return;
  const int i = settings_.normal();
  double K = settings_.constants[0].stiffness[i], B = settings_.constants[0].damping[i];
  const double off = std::max(e.damping_std, e.stiffness * settings_.tick);
  if (settings_.compensation.damping && e.stiffness >= 0 && 5 * off <= e.damping) B = e.damping;
  if (e.stiffness >= 0) K = std::min(e.stiffness, settings_.stiffness_max);
  for (NodeData& node : state.series.nodes) node.stiffness[i] = K, node.damping[i] = B;
  state.memory.contact.stiffness[i] = K;
  state.memory.contact.damping[i] = B;
}

// Gives each node the weights and the contact of its own phase. A reference without phases has the first one that is
// (not) in contact, as the estimate says.
Refusal Controller::write_phases(const Estimated& e, State& state) const {
  const Settings& s = settings_;
  const bool touches = e.contact == 1;
  const auto felt =
      std::find_if(s.phases.begin(), s.phases.end(), [&](const Phase& p) { return p.contact == touches; });
  const int unnamed = felt == s.phases.end() ? unnamed_phase : int(felt - s.phases.begin());
  std::vector<int>& written = state.series.phases;
  bool same = state.memory.oriented == state.horizon.oriented;
  for (size_t k = 0; k < state.horizon.nodes.size(); ++k) {
    int& phase = state.horizon.nodes[k].phase;
    if (!s.named_phases || phase == unnamed_phase) phase = unnamed;
    if (phase == unnamed_phase) return {Fault::no_phase_for_contact, int(k), double(touches)};
    if (phase == unknown_phase) return {Fault::unknown_phase, int(k)};
    same = same && written[k] == phase;
  }
  if (same) return {};
  for (size_t k = 0; k < state.horizon.nodes.size(); ++k) {
    const Phase& phase = s.phases[size_t(state.horizon.nodes[k].phase)];
    NodeData& node = state.series.nodes[k];
    copy_weights(phase.nodes[k], node);
    node.contact_active = s.m() > 0 && phase.contact;
    if (!state.horizon.oriented) std::fill(node.rotation_weight, node.rotation_weight + 3, 0.0);
    written[k] = state.horizon.nodes[k].phase;
  }
  state.memory.oriented = state.horizon.oriented;
  return {};
}

void Controller::write_references(State& state) const {
  const Settings& s = settings_;
  const bool postured = s.reference_posture && state.horizon.postured;
  for (size_t k = 0; k < state.horizon.nodes.size(); ++k) {
    const NodeReference& wanted = state.horizon.nodes[k];
    NodeData& node = state.series.nodes[k];
    const double* posture = postured ? wanted.posture : state.memory.posture;
    std::copy(posture, posture + s.n(), node.state_reference);
    copy(node.translation_reference, wanted.position);
    copy(node.rotation_reference, state.horizon.oriented ? wanted.rotation : identity);
    const double* task = state.horizon.turning ? wanted.task_rotation : nullptr;
    if (s.model.axes == Axes::surface) copy(node.task_rotation, contact_axes(s, nullptr, task));
    if (s.task_velocity) copy(node.velocity_reference, wanted.velocity);
    if (s.m())
      in_contact_axes(s, wanted.wrench, contact_axes(s, state.horizon.oriented ? wanted.rotation : nullptr, task),
                      node.force_reference);
    for (int j = 0; s.torque_bounds && j < s.n(); ++j) {  // of a torque ũ of which ũ − disturbance is sent
      node.torque_lower[j] = state.memory.disturbance[j] - s.torque_limit[j];
      node.torque_upper[j] = state.memory.disturbance[j] + s.torque_limit[j];
    }
  }
}

// Where the contact rests: where it began, or where the reference will be when it begins.
void Controller::write_anchor(const double* x, State& state) const {
  std::vector<NodeData>& nodes = state.series.nodes;
  const bool touching = nodes.front().contact_active;
  if (touching && !state.memory.touching) {
    double R[9], p[3];
    kernel(settings_.n(), settings_.model).placement(settings_.chain, true, x, R, p);
    for (NodeData& node : nodes) {
      copy(node.anchor_translation, p);
      copy(node.anchor_rotation, R);
    }
  } else if (!touching) {
    for (size_t k = 0; k < nodes.size(); ++k) {
      copy(nodes[k].anchor_translation, state.horizon.nodes[k].position);
      if (state.horizon.oriented) copy(nodes[k].anchor_rotation, state.horizon.nodes[k].rotation);
    }
  }
  state.memory.touching = touching;
}

// A solution may be sent if it is finite and follows the dynamics; it need not be optimal. With a joint torque in the
// state the unfiltered w is too aggressive to send: an interpolation from the measured torque to the predicted one goes
// to the robot, τ_0 + ε (τ_1 − τ_0) with ε = T_mpc/dt ([FFMPC] eq. 15).
void Controller::keep_solution(const Estimated& e, State& state) const {
  const Settings& s = settings_;
  const int n = s.n(), nx = s.nx();
  Memory& memory = state.memory;
  const OwnedEngine& solver = state.solver;
  solver.table->get_plan(solver.engine, state.xs.data(), state.us.data());
  solver.table->get_feedback(solver.engine, nullptr, state.series.forces.data());
  solver.table->tool_path(solver.engine, state.series.path.data());
  memory.deadline_missed = s.deadline >= 0 && memory.report.seconds > s.deadline;
  memory.contact_nodes = int(std::count_if(state.series.nodes.begin(), state.series.nodes.end(),
                                           [](const NodeData& node) { return node.contact_active; }));
  const bool broken = memory.report.status == Status::nan || memory.report.status == Status::not_positive_definite;
  if (broken || !all_finite(state.us) || !all_finite(state.xs) || !(memory.report.gap <= s.max_gap)) {
    ++memory.failures;
    return;
  }
  for (int k = 0; k < s.N(); ++k)
    for (int j = 0; j < n; ++j) {
      const double *now = &state.xs[size_t(k * nx + 2 * n)], *then = now + nx;
      const double torque =
          s.torque_state() ? now[j] + s.interpolation * (then[j] - now[j]) : state.us[size_t(k * n + j)];
      state.series.torques[size_t(k * n + j)] = torque;
    }
  if (s.riccati) solver.table->get_feedback(solver.engine, state.series.gain.data(), nullptr);
  std::copy(state.xs.begin(), state.xs.begin() + nx, memory.x0);
  memory.plan_time = e.time;
  memory.has_plan = true;
  memory.failures = 0;
}

}  // namespace pliant::mpc::step
