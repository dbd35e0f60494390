#include "controller.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "../validate.hpp"
#include "prediction.hpp"

namespace pliant::mpc::step {
namespace {

constexpr double turn = 2 * 3.14159265358979323846;  // [rad]
constexpr double clock_rounding = 1e-9;              // [s] smaller than any period, larger than the rounding of a clock

void copy(double* to, const double* from, int count) { std::memcpy(to, from, size_t(count) * sizeof(double)); }

bool all_finite(const double* values, size_t count) {
  for (size_t i = 0; i < count; ++i)
    if (!std::isfinite(values[i])) return false;
  return true;
}

}  // namespace

Controller::Controller(Settings settings) : settings_(std::move(settings)) {}

bool Controller::fits(const State& state) const {
  const Settings& s = settings_;
  const size_t n = size_t(s.n());
  return state.chain.dof == s.n() && state.model.kind == s.model.kind && state.model.contact_dim == s.m() &&
         state.options.horizon == s.N() && state.series.commands.size() == size_t(s.compensation.under_way + 1) * n &&
         state.series.wanted.size() == size_t(s.compensation.averaged) * n;
}

bool Controller::due(double time, const State& state) const {
  const double next = state.memory.next_solve;
  const bool turned_back = time < next - settings_.period - clock_rounding;
  return turned_back || time >= next - clock_rounding;
}

Refusal Controller::step(const Estimated& e, const Wanted* wanted, const double* R_world_task, State& state,
                         Answer& answer) const {
  const Settings& s = settings_;
  const int n = s.n();
  Memory& memory = state.memory;
  if (s.force_state() && !e.wrench) return {Fault::no_wrench};
  if (s.compensation.disturbance && !e.disturbance) return {Fault::no_disturbance};
  double measured[3 * max_joints];
  answer.solved = wanted && due(e.time, state);
  const double* x = nullptr;  // of now, where somebody asks for it and it is finite
  if ((answer.solved || s.riccati) && measured_state(e, R_world_task, measured)) x = measured;
  if (all_finite(e.q, size_t(n)) && all_finite(e.v, size_t(n))) {
    copy(memory.q, e.q, n);
    copy(memory.v, e.v, n);
  }
  if (s.compensation.disturbance && all_finite(e.disturbance, size_t(n))) copy(memory.disturbance, e.disturbance, n);
  if (answer.solved) {
    const Refusal refusal = solve(e, *wanted, x, R_world_task, state);
    if (refusal.fault != Fault::none) return refusal;
    memory.next_solve = e.time + s.period;
  }
  double torque[max_joints], within[max_joints];
  answer.source = wanted_torque(e.time, x, state, torque);
  for (int j = 0; j < n; ++j) {
    within[j] = std::min(std::max(torque[j], -s.torque_limit[j]), s.torque_limit[j]);
    answer.clamped[j] = torque[j] - within[j];
  }
  send(within, state, answer.torque);
  return {};
}

// x of now: q, v and, by kind, contact force (in axes of the task, where it has some) or joint torque. False: a value
// is not finite.
bool Controller::measured_state(const Estimated& e, const double* R_world_task, double* x) const {
  const Settings& s = settings_;
  const int n = s.n();
  copy(x, e.q, n);
  copy(x + n, e.v, n);
  if (s.torque_state()) copy(x + 2 * n, e.torque, n);
  if (!all_finite(x, size_t(2 * n + (s.torque_state() ? n : 0)))) return false;
  if (!s.force_state()) return true;
  double R[9], p[3];
  const bool local = s.model.axes == Axes::local;
  if (local) kernel(n, s.model).placement(s.chain, true, e.q, R, p);
  in_contact_axes(s, e.wrench, contact_axes(s, local ? R : nullptr, R_world_task), x + 2 * n);
  return all_finite(x + 2 * n, size_t(s.m()));
}

// The plan's torque, without the disturbance.
Source Controller::wanted_torque(double time, const double* x, const State& state, double* torque) const {
  const Settings& s = settings_;
  const int n = s.n(), nx = s.nx();
  const Memory& memory = state.memory;
  const double step = std::floor((time - memory.plan_time) / s.options.dt + 1e-9);
  if (memory.has_plan && step >= 0 && step < s.N()) {
    copy(torque, &state.series.torques[size_t(int(step) * n)], n);
    for (int j = 0; step == 0 && s.riccati && x && j < n; ++j)
      for (int i = 0; i < nx; ++i) torque[j] -= state.series.gain[size_t(j * nx + i)] * (x[i] - memory.x0[i]);
    if (all_finite(torque, size_t(n))) {
      for (int j = 0; j < n; ++j) torque[j] -= memory.disturbance[j];
      return memory.failures ? Source::old_plan : Source::plan;
    }
  }
  double q[max_joints];  // of revolute joints within one turn: the kernel's sine knows no absurd angles
  for (int j = 0; j < n; ++j) q[j] = s.chain.prismatic[j] ? memory.q[j] : std::remainder(memory.q[j], turn);
  kernel(n, s.model).gravity(s.chain, q, torque);
  for (int j = 0; j < n; ++j) {
    torque[j] -= s.fallback_damping * memory.v[j];
    if (!std::isfinite(torque[j])) torque[j] = 0;
  }
  return Source::gravity_and_damping;
}

// The mean of the last wanted torques, and what is remembered of both.
void Controller::send(const double* within, State& state, double* torque) const {
  const int n = settings_.n(), averaged = settings_.compensation.averaged;
  std::vector<double>&wanted = state.series.wanted, &commands = state.series.commands;
  std::copy(wanted.begin() + n, wanted.end(), wanted.begin());
  std::copy(within, within + n, wanted.end() - n);
  for (int j = 0; j < n; ++j) {
    double sum = wanted[size_t(j)];
    for (int i = 1; i < averaged; ++i) sum += wanted[size_t(i * n + j)];
    torque[j] = averaged == 1 ? within[j] : sum / averaged;
  }
  std::copy(commands.begin() + n, commands.end(), commands.begin());
  std::copy(torque, torque + n, commands.end() - n);
}

}  // namespace pliant::mpc::step
