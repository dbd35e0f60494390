// A controller's step without Python: nothing is taken from the heap, torques are finite and within the limits whatever
// is measured, a copied state goes on alone and says the same.
#include <cmath>
#include <cstdio>
#include <limits>
#include <thread>

#include "../../tests/checks.hpp"
#include "../step/controller.hpp"
#include "arm.hpp"

namespace pliant::mpc::step {
namespace {

using namespace pliant::testing;

constexpr int dof = 7, N = 5;
constexpr double tick = 1e-3, inf = std::numeric_limits<double>::infinity();  // [s]
constexpr double home[max_joints] = {0.1, 0.6, 0.1, 0.6, 0.1, 0.6, 0.1};

Settings settings(Kind kind, int dim, Axes axes, bool bounded, bool late) {
  Settings s{};
  s.chain = arm(dof);
  s.model = model(kind, dim, axes, late && kind == Kind::force_feedback ? Integrator::exponential : Integrator::euler);
  s.options = {N, 3e-3, 1e-9, 8, 10, bounded};
  s.limits = {8, 1e-4, -1};
  s.period = 2e-3;
  s.tick = tick;
  s.interpolation = 2.0 / 3.0;
  s.max_gap = 10;
  s.fallback_damping = 5;
  s.deadline = -1;
  s.reference_posture = s.task_velocity = s.named_phases = true;
  s.torque_bounds = bounded;
  for (double& limit : s.torque_limit) limit = 100;
  identity(s.surface);
  s.stiffness_max = 1e4;
  s.compensation = {true, true, 20, 10, late ? 4 : 0, late ? 4 : 1, late ? 2 : 0, late ? 5e-3 : 0};
  s.constants.assign(N + 1, parameters(dof, home, bounded));
  for (NodeData& node : s.constants) node.force_reference[0] = 0;
  s.phases = {{s.constants, false}, {s.constants, true}};
  return s;
}

// What a robot tells in a tick.
struct Told {
  double q[max_joints], v[max_joints], torque[max_joints], wrench[6], disturbance[max_joints];
  double position[3], velocity[6] = {}, force[6] = {}, times[N + 1], positions[N + 1][3], turns[N + 1][9];
  double velocities[N + 1][6] = {}, forces[N + 1][6] = {};
  Estimated estimate{};
  Ahead ahead;
  Wanted wanted{};

  void at(int count, Noise& noise, double lead) {
    const bool touches = count % 40 > 20;
    for (int i = 0; i < dof; ++i) {
      q[i] = home[i] + 1e-3 * noise();
      v[i] = 1e-2 * noise();
      torque[i] = 5 * noise();
      disturbance[i] = noise();
    }
    for (double& w : wrench) w = 0.1 * noise();
    wrench[2] += touches ? 5 : 0;
    if (count % 50 == 33) q[count % dof] = std::nan("");
    if (count % 50 == 35) wrench[2] = inf;
    estimate = {count * tick, q, v, torque, wrench, disturbance, touches, 2e3, 20.0, 2.0};
    for (int i = 0; i < 3; ++i) position[i] = (i == 2 ? 1.3 : 0.1) + 1e-3 * noise();
    for (int k = 0; k <= N; ++k) {
      times[k] = estimate.time + lead + 3e-3 * k;
      identity(turns[k]);
      for (int i = 0; i < 3; ++i) positions[k][i] = position[i];
      forces[k][2] = touches ? 5 : 0;
      ahead.phase[size_t(k)] = touches;
    }
    ahead.count = N + 1;
    ahead.time = {times, 1};
    ahead.position = {positions[0], 3};
    ahead.rotation = {turns[0], 9};
    ahead.velocity = {velocities[0], 6};
    ahead.wrench = {forces[0], 6};
    wanted.time = estimate.time;
    wanted.has_task = wanted.has_any = true;
    wanted.task = wanted.first = {position, turns[0], velocity, forces[0], nullptr};
    wanted.phase = touches;
    wanted.has_ahead = count % 3 > 0;
    wanted.ahead = &ahead;
  }
};

void run_steps(const Settings& s, const char* name, double* last) {
  const Controller controller(s);
  Told told;
  told.ahead.phase.resize(N + 1);
  Noise noise;
  told.at(0, noise, s.compensation.lead);
  State state(s, 0, told.q, told.v, told.torque);
  Answer answer{};
  const int before = allocations;
  for (int count = 0; count < 100; ++count) {
    told.at(count, noise, s.compensation.lead);
    const Refusal refusal = controller.step(told.estimate, &told.wanted, nullptr, state, answer);
    check(refusal.fault == Fault::none, "a step has an answer", name);
    for (int i = 0; i < dof; ++i) {
      check(std::isfinite(answer.torque[i]), "a torque is finite", name);
      check(std::abs(answer.torque[i]) <= s.torque_limit[i] + 1e-12, "a torque is within its limit", name);
    }
  }
  check(allocations == before, "a step takes nothing from the heap", name);
  State copy(state);
  check(allocations > before, "the counter counts a copy", name);  // baseline
  Answer of_copy{};
  for (int count = 100; count < 110; ++count) {
    told.at(count, noise, s.compensation.lead);
    controller.step(told.estimate, &told.wanted, nullptr, state, answer);
    controller.step(told.estimate, &told.wanted, nullptr, copy, of_copy);
    for (int i = 0; i < dof; ++i) check(answer.torque[i] == of_copy.torque[i], "a copy says the same", name);
  }
  for (int i = 0; i < dof; ++i) last[i] = answer.torque[i];
}

void refuse(const Settings& s) {
  const Controller controller(s);
  Told told;
  told.ahead.phase.resize(N + 1);
  Noise noise;
  told.at(1, noise, s.compensation.lead);
  State state(s, 0, told.q, told.v, told.torque);
  Answer answer{};
  told.ahead.phase[3] = unknown_phase;
  Refusal refusal = controller.step(told.estimate, &told.wanted, nullptr, state, answer);
  check(refusal.fault == Fault::unknown_phase && refusal.node == 3, "a phase without costs is refused", "refusals");
  told.at(1, noise, s.compensation.lead);
  told.forces[2][2] = -5;
  refusal = controller.step(told.estimate, &told.wanted, nullptr, state, answer);
  check(refusal.fault == Fault::pulls && refusal.node == 2, "a force that pulls is refused", "refusals");
  told.at(1, noise, s.compensation.lead);
  told.estimate.wrench = nullptr;
  refusal = controller.step(told.estimate, &told.wanted, nullptr, state, answer);
  check(refusal.fault == Fault::no_wrench, "a missing wrench is refused", "refusals");
}

void run() {
  double last[max_joints], again[max_joints];
  for (bool late : {false, true}) {
    run_steps(settings(Kind::force_feedback, 1, Axes::world, false, late), "force 1", last);
    run_steps(settings(Kind::force_feedback, 1, Axes::world, true, late), "force 1, bounds", last);
    run_steps(settings(Kind::force_feedback, 3, Axes::local, false, late), "force 3, local", last);
    run_steps(settings(Kind::torque_feedback, 1, Axes::world, false, late), "torque", last);
    run_steps(settings(Kind::classical, 1, Axes::surface, true, late), "classical, bounds", last);
  }
  const Settings shared = settings(Kind::force_feedback, 1, Axes::world, false, true);
  std::thread other([&] { run_steps(shared, "beside", again); });
  other.join();
  run_steps(shared, "after", last);
  for (int i = 0; i < dof; ++i) check(last[i] == again[i], "another thread says the same", "threads");
  refuse(shared);
}

}  // namespace
}  // namespace pliant::mpc::step

int main() {
  pliant::mpc::step::run();
  return pliant::testing::result();
}
