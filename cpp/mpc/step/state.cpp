#include "state.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <new>

#include "../models.hpp"

namespace pliant::mpc::step {
namespace {

double clipped(double value, double limit) {
  if (std::isnan(value)) return 0;
  return std::min(std::max(value, -limit), limit);
}

Series first_series(const Settings& s, const double* torque_sent) {
  const size_t n = size_t(s.n()), N = size_t(s.N());
  Series series;
  series.torques.assign(N * n, 0);
  series.gain.assign(n * size_t(s.nx()), 0);
  for (int i = 0; i <= s.compensation.under_way; ++i)
    for (size_t j = 0; j < n; ++j) series.commands.push_back(clipped(torque_sent[j], s.torque_limit[j]));
  for (int i = 0; i < s.compensation.averaged; ++i)
    for (size_t j = 0; j < n; ++j) series.wanted.push_back(clipped(torque_sent[j], s.torque_limit[j]));
  series.path.assign(3 * (N + 1), 0);
  series.forces.assign(N * size_t(s.m()), 0);
  series.nodes = s.constants;
  series.phases.assign(N + 1, unknown_phase);  // equal to none that is written
  return series;
}

}  // namespace

OwnedEngine::OwnedEngine(const ChainData& chain, const ModelData& model, const Options& options)
    : table(&kernel(chain.dof, model)), engine(table->create(chain, model, options)) {
  if (!engine) throw std::bad_alloc();
}

State::State(const Settings& s, double time, const double* q, const double* v, const double* torque_sent)
    : series(first_series(s, torque_sent)),
      chain(s.chain),
      model(s.model),
      options(s.options),
      tick(s.tick),
      solver(chain, model, options),
      prediction(chain, driven_model(model), {1, tick, 0, 1, 1, false}) {
  const size_t n = size_t(s.n());
  memory.next_solve = time;
  std::memcpy(memory.q, q, n * sizeof(double));
  std::memcpy(memory.posture, q, n * sizeof(double));
  std::memcpy(memory.v, v, n * sizeof(double));
  memory.contact = s.constants.front();
  memory.report.status = Status::nan;
  restore({std::vector<double>(size_t((s.N() + 1) * s.nx())), std::vector<double>(size_t(s.N()) * n), {}});
}

State::State(const Memory& m, const Series& s, const Kept& kept, const ChainData& c, const ModelData& mod,
             const Options& o, double t)
    : memory(m),
      series(s),
      chain(c),
      model(mod),
      options(o),
      tick(t),
      solver(chain, model, options),
      prediction(chain, driven_model(model), {1, tick, 0, 1, 1, false}) {
  restore(kept);
}

State::State(const State& other)
    : State(other.memory, other.series, other.kept(), other.chain, other.model, other.options, other.tick) {}

Kept State::kept() const {
  const size_t N = size_t(options.horizon), nodes = options.bounds ? N + 1 : 0;
  Kept found{std::vector<double>((N + 1) * size_t(state_dim(model, chain.dof))),
             std::vector<double>(N * size_t(chain.dof)), std::vector<double>(nodes * multipliers_per_node)};
  solver.table->get_plan(solver.engine, found.xs.data(), found.us.data());
  solver.table->get_multipliers(solver.engine, found.multipliers.data());
  return found;
}

void State::restore(const Kept& kept) {
  xs = kept.xs;
  us = kept.us;
  horizon.nodes.resize(series.nodes.size());
  solver.table->set_plan(solver.engine, xs.data(), us.data());
  if (!kept.multipliers.empty()) solver.table->set_multipliers(solver.engine, kept.multipliers.data());
}

}  // namespace pliant::mpc::step
