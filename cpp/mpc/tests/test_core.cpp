// The core without Python: every model solves, nothing is taken from the heap while it does, plans stay finite.
#include <cmath>
#include <cstdio>
#include <limits>
#include <stdexcept>
#include <vector>

#include "../../tests/checks.hpp"
#include "../dispatch.hpp"
#include "../validate.hpp"

namespace pliant::mpc {
namespace {

using namespace pliant::testing;

void identity(double* R) {
  for (int i = 0; i < 9; ++i) R[i] = i % 4 == 0;
}

// An arm of upright links 0.2 m long whose axes alternate between z and y.
ChainData arm(int dof) {
  ChainData c{};
  c.dof = dof;
  c.gravity[2] = -9.81;  // [m/s²]
  for (int i = 0; i < dof; ++i) {
    identity(c.rotation[i]);
    c.translation[i][2] = 0.2;  // [m]
    c.axis[i][i % 2 ? 1 : 2] = 1;
    c.mass[i] = 2.0;    // [kg]
    c.com[i][2] = 0.1;  // [m]
    for (int d = 0; d < 3; ++d) c.inertia[i][4 * d] = 0.01;
    c.rotor_inertia[i] = 0.05;  // [kg m²]
  }
  identity(c.tool_rotation);
  identity(c.contact_rotation);
  c.tool_translation[2] = c.contact_translation[2] = 0.1;
  return c;
}

ModelData model(Kind kind, int dim, Axes axes, Integrator integrator) {
  ModelData m{};
  m.kind = kind;
  m.contact_dim = dim;
  m.axes = axes;
  m.integrator = integrator;
  m.torque_bandwidth = 50;
  m.baumgarte_velocity = 10;
  return m;
}

NodeData parameters(int dof, const double* home, bool bounded) {
  const double inf = std::numeric_limits<double>::infinity();
  NodeData d{};
  identity(d.task_rotation);
  identity(d.rotation_reference);
  identity(d.anchor_rotation);
  for (int i = 0; i < dof; ++i) {
    d.state_reference[i] = home[i];
    d.state_weight[i] = 0.2;
    d.state_weight[dof + i] = 0.04;
    d.torque_gravity_weight[i] = 1e-4;
    d.control_gravity_weight[i] = 1e-6;
    d.torque_lower[i] = bounded ? -100 : -inf;
    d.torque_upper[i] = bounded ? 100 : inf;
  }
  for (int i = 0; i < 6; ++i) d.velocity_weight[i] = 0.05;
  for (int c = 0; c < max_contact; ++c) {
    d.force_weight[c] = 0.01;
    d.force_rate_weight[c] = 6e-7;
    d.stiffness[c] = 1e3;
    d.damping[c] = 1e2;
    d.force_lower[c] = bounded ? -3 : -inf;
    d.force_upper[c] = bounded ? 3 : inf;
  }
  d.force_reference[0] = 5;  // [N], beyond the bound
  d.friction = bounded ? 0.5 : inf;
  d.sliding_friction = inf;
  d.contact_active = true;
  return d;
}

void solve_repeatedly(int dof, const ModelData& m, bool bounded, const char* name,
                      double sliding_friction = std::numeric_limits<double>::infinity()) {
  constexpr int N = 5;
  const ChainData chain = arm(dof);
  double home[max_joints];
  for (int i = 0; i < dof; ++i) home[i] = i % 2 ? 0.6 : 0.1;
  std::vector<NodeData> nodes(N + 1, parameters(dof, home, bounded));
  for (NodeData& node : nodes) {
    node.sliding_friction = sliding_friction;
    if (!std::isfinite(sliding_friction)) continue;
    node.force_reference[0] = 0;  // along the surface friction would not carry it ...
    node.force_reference[2] = 5;
    for (int c = 0; c < 2; ++c) node.force_weight[c] = node.force_rate_weight[c] = 0;  // ... nor do costs belong there
  }
  validate(chain);
  validate(m);
  validate(nodes[0], 0, dof, m, 3e-3);
  const KernelTable& k = kernel(dof, m);
  const int before_construction = allocations;
  Engine* engine = k.create(chain, m, {N, 3e-3, 1e-9, 8, 10, bounded});
  check(engine != nullptr, "an engine is made", name);
  check(allocations > before_construction, "the counter counts construction", name);  // baseline
  double x0[3 * max_joints] = {}, xs[(N + 1) * 3 * max_joints], us[N * max_joints];
  Noise noise;
  int converged = 0, cycles = 50;
  const int before = allocations;
  for (int cycle = 0; cycle < cycles; ++cycle) {
    for (int i = 0; i < dof; ++i) x0[i] = home[i] + 1e-3 * noise();
    if (cycle == 0) k.quasi_static(engine, nodes.data(), x0);
    Report report;
    k.solve(engine, nodes.data(), x0, {20, 1e-4, -1}, report);
    k.shift(engine);
    converged += report.status == Status::converged;
  }
  check(allocations == before, "nothing is allocated while solving", name);
  check(converged >= cycles - 1, "the loop converges", name);
  k.get_plan(engine, xs, us);
  for (int i = 0; i < N * dof; ++i) check(std::isfinite(us[i]), "the plan is finite", name);
  k.destroy(engine);
}

void run() {
  for (int dof : {1, 3, 7, 8})
    for (bool bounded : {false, true}) {
      solve_repeatedly(dof, model(Kind::force_feedback, 1, Axes::world, Integrator::euler), bounded, "force 1");
      solve_repeatedly(dof, model(Kind::force_feedback, 1, Axes::local, Integrator::exponential), bounded, "force exp");
      solve_repeatedly(dof, model(Kind::free, 0, Axes::world, Integrator::euler), bounded, "free");
      if (dof < 7) continue;
      solve_repeatedly(dof, model(Kind::force_feedback, 3, Axes::surface, Integrator::euler), false, "force 3");
      solve_repeatedly(dof, model(Kind::force_feedback, 6, Axes::world, Integrator::euler), false, "force 6");
      solve_repeatedly(dof, model(Kind::force_feedback, 3, Axes::local, Integrator::euler), false, "sliding 3", 0.3);
      solve_repeatedly(dof, model(Kind::force_feedback, 6, Axes::surface, Integrator::euler), false, "sliding 6", 0.3);
      solve_repeatedly(dof, model(Kind::classical, 1, Axes::world, Integrator::euler), bounded, "classical 1");
      solve_repeatedly(dof, model(Kind::classical, 3, Axes::local, Integrator::euler), false, "classical 3");
      solve_repeatedly(dof, model(Kind::torque_feedback, 1, Axes::world, Integrator::euler), bounded, "torque 1");
    }
  bool refused = false;
  try {
    use_instruction_set("abacus");
  } catch (const std::invalid_argument&) {
    refused = true;
  }
  check(refused, "an unknown instruction set is refused", "dispatch");
}

}  // namespace
}  // namespace pliant::mpc

int main() {
  try {
    std::printf("instruction set %s\n", pliant::mpc::instruction_set().c_str());
  } catch (const std::invalid_argument& error) {
    std::printf("skipped: %s\n", error.what());
    return 77;
  }
  pliant::mpc::run();
  return pliant::testing::result();
}
