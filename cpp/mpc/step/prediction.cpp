#include "prediction.hpp"

#include <algorithm>
#include <cstring>

#include "../validate.hpp"

namespace pliant::mpc::step {
namespace {

// The mean of the torques that will have been wanted `later` periods from now, the newest one going on.
void averaged(const Settings& s, const State& state, int later, double* torque) {
  const int n = s.n(), count = s.compensation.averaged;
  for (int j = 0; j < n; ++j) {
    double sum = 0;
    for (int i = 0; i < count; ++i) sum += state.series.wanted[size_t(std::min(i + later, count - 1) * n + j)];
    torque[j] = sum / count;
  }
}

}  // namespace

void roll_ahead(const Settings& s, bool touching, State& state, double* x) {
  const int n = s.n(), under_way = s.compensation.under_way, late = s.compensation.late;
  if (under_way + late == 0) return;
  NodeData& node = state.memory.contact;
  node.contact_active = touching;
  const ModelData model = driven_model(s.model);
  validate(node, 0, n, model, s.tick);
  const OwnedEngine& engine = state.prediction;
  if (s.force_state() && model.integrator == Integrator::exponential)
    engine.table->freeze(engine.engine, node.task_rotation, x);
  double torque[max_joints] = {}, next[3 * max_joints], unused[max_joints];
  NodeOutput out{};
  out.x_next = next;
  out.acceleration = out.force = out.force_rate = unused;
  for (int step = 0; step < under_way + late; ++step) {
    if (step < under_way)
      std::memcpy(torque, &state.series.commands[size_t((step + 1) * n)], size_t(n) * sizeof(double));
    else
      averaged(s, state, step - under_way + 1, torque);
    for (int j = 0; j < n; ++j) torque[j] += state.memory.disturbance[j];
    engine.table->node(engine.engine, node, false, false, x, torque, out);
    const int size = 2 * n + (s.force_state() ? s.m() : 0);
    std::memcpy(x, next, size_t(size) * sizeof(double));
    if (s.force_state()) x[2 * n + s.normal()] = std::max(x[2 * n + s.normal()], 0.0);
  }
  if (!s.torque_state()) return;
  for (int j = 0; j < n; ++j) {
    const double acted = state.series.commands[size_t(j)] + state.memory.disturbance[j];
    x[2 * n + j] = x[2 * n + j] + torque[j] - acted;
  }
}

}  // namespace pliant::mpc::step
