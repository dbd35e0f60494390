// The core without Python: every model solves, nothing is taken from the heap while it does, plans stay finite.
#include <cmath>
#include <cstdio>
#include <limits>
#include <stdexcept>
#include <vector>

#include "../../tests/checks.hpp"
#include "../dispatch.hpp"
#include "../validate.hpp"
#include "arm.hpp"

namespace pliant::mpc {
namespace {

using namespace pliant::testing;

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
  for (int dof : {1, 3, 4, 7, 8})
    for (bool bounded : {false, true}) {
      solve_repeatedly(dof, model(Kind::force_feedback, 1, Axes::world, Integrator::euler), bounded, "force 1");
      solve_repeatedly(dof, model(Kind::force_feedback, 1, Axes::local, Integrator::exponential), bounded, "force exp");
      solve_repeatedly(dof, model(Kind::free, 0, Axes::world, Integrator::euler), bounded, "free");
      if (dof < 4) continue;
      solve_repeatedly(dof, model(Kind::force_feedback, 3, Axes::surface, Integrator::euler), false, "force 3");
      solve_repeatedly(dof, model(Kind::force_feedback, 6, Axes::world, Integrator::euler), false, "force 6");
      if (dof < 7) continue;
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
