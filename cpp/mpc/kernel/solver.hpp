// The solver's memory and parts; its methods are in the sqp files.
#pragma once
#include <new>

#include "array.hpp"
#include "bound_search.hpp"
#include "bounds.hpp"
#include "force_feedback.hpp"
#include "output_force.hpp"
#include "rest.hpp"
#include "riccati.hpp"
#include "state_map.hpp"

namespace pliant::mpc::PLIANT_ISA {

// A trajectory with its expansions: the current iterate, or a trial of the line search.
template <class L>
struct Iterate {
  Array<Row<L>> x, gap;
  Array<Lanes> u;
  Array<NodeValues<L>> node;
  double cost = 0, gap_sum = 0;
  double infeasibility = 0;  // Σ |gaps| + Σ bound violations
  double violation = 0;      // ∞-norm

  bool allocate(int N) { return x.allocate(N + 1) && gap.allocate(N + 1) && u.allocate(N) && node.allocate(N + 1); }
};

template <class L>
class Solver {
 public:
  Chain chain;
  ModelConstants model;
  Options options;
  StateMap<L> map;
  Step<L> step;

  bool allocate(const ChainData& chain_data, const ModelData& model_data, const Options& opts) {
    options = opts;
    chain = make_chain(chain_data, L::J);
    model.data = model_data;
    const double pi = 3.14159265358979323846;
    model.disc = {opts.dt,
                  exp(-2 * pi * model_data.torque_bandwidth * opts.dt),
                  L::extra == Extra::force && model_data.integrator == Integrator::exponential,
                  {}};
    map = {chain_data.dof, L::has_torque ? chain_data.dof : L::M};
    step = Step<L>(chain, opts.dt, model.disc.alpha);
    const int N = opts.horizon;
    return iterates[0].allocate(N) && iterates[1].allocate(N) && stages.allocate(N + 1) && factors.allocate(N + 1) &&
           dx.allocate(N + 1) && du.allocate(N) && costates.allocate(N + 1) && filter_cost.allocate(opts.filter_size) &&
           filter_infeasibility.allocate(opts.filter_size) &&
           (!opts.bounds || (bounds.allocate(N + 1) && multipliers.allocate(N + 1) && terms.allocate(N + 1) &&
                             expansions.allocate(N + 1) && from_x.allocate(N + 1) && from_u.allocate(N) &&
                             from_values.allocate(N + 1) && to_values.allocate(N + 1)));
  }

  void prepare(const NodeData* nodes, int k) {
    const bool terminal = k == options.horizon;
    make_stage(nodes[k], model.data, model.disc, chain.dof, terminal, stages[k]);
    if (options.bounds) make_stage_bounds(nodes[k], model.data, chain.dof, k == 0, terminal, bounds[k]);
  }

  void evaluate_node(const Stage& s, const Row<L>& x, const Lanes& u, bool derivatives, NodeValues<L>& out) const {
    if constexpr (L::extra == Extra::force)
      force_feedback_node<L>(chain, model, s, x, u, derivatives, out);
    else
      output_force_node<L>(chain, model, s, x, u, derivatives, out);
  }

  // Inverse task inertia diag(J M⁻¹ Jᵀ) at q, in the axes of a node, for the exponential step.
  void freeze(const Mat& task, const Lanes& q) {
    Rest<L::J> rest;
    make_rest<L::J>(chain, model.data, task, q, rest);
    for (int i = 0; i < model.data.contact_dim; ++i) model.disc.inverse_inertia[i] = rest.inverse_inertia[i];
  }

  void solve(const NodeData* nodes, const double* x0, const Limits& limits, Report& report);
  Iterate<L>& current() { return iterates[active]; }
  const Iterate<L>& current() const { return iterates[active]; }

  Array<StageFactor<L>> factors;
  Array<Stage> stages;
  Array<BoundVector> multipliers;

 private:
  Iterate<L> iterates[2];
  int active = 0;
  Array<Row<L>> dx, costates;
  Array<Lanes> du;
  Array<double> filter_cost, filter_infeasibility;
  double regularisation = 0;
  Array<StageBounds> bounds;
  Array<BoundTerms> terms;
  Array<Expansion<L>> expansions;
  Array<Row<L>> from_x;  // the direction before a Newton step, and the bounds' values before and after it
  Array<Lanes> from_u;
  Array<BoundValues> from_values, to_values;

  void evaluate(Iterate<L>& it);
  const Expansion<L>& expansion(const Iterate<L>& it, int k) const {
    return options.bounds ? expansions[k] : static_cast<const Expansion<L>&>(it.node[k]);
  }
  bool backward(const Iterate<L>& it);
  void forward(const Iterate<L>& it);
  bool newton_step(Report& report);
  void bounded_values(const Iterate<L>& it, int k, BoundValues& values) const;
  double search_direction(const Iterate<L>& it);
  DualError model_error(const Iterate<L>& it);
  double update_multipliers();
  bool bounded_step(double tolerance, Report& report);
  double optimality(const Iterate<L>& it) const;
  bool line_search(int iteration, Report& report);
  bool acceptable(const Iterate<L>& trial, int iteration) const;
  Status iterate(const Limits& limits, double start, Report& report);
};

}  // namespace pliant::mpc::PLIANT_ISA
