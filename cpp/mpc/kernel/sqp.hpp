// Stagewise sequential quadratic programming with a filter line search, after Jordana, Kleff, Meduri, Carpentier,
// Mansard and Righetti, "Stagewise implementations of sequential quadratic programming for model-predictive control"
// (2023). All memory is taken at construction.
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

template <class L>
void Solver<L>::evaluate(Iterate<L>& it) {
  const int N = options.horizon;
  it.cost = 0;
  it.gap_sum = 0;
  it.violation = 0;
  double outside = 0;
  for (int k = 0; k <= N; ++k) {
    evaluate_node(stages[k], it.x[k], k < N ? it.u[k] : zero(), true, it.node[k]);
    it.cost += it.node[k].cost;
    if (options.bounds) {
      const Violation v = bound_violation(bounds[k], k < N ? it.u[k] : zero(), it.node[k].force);
      outside += v.sum;
      it.violation = larger(it.violation, v.worst);
    }
    if (k == N) break;
    for (int b = 0; b < L::blocks; ++b) it.gap[k + 1].block[b] = it.node[k].x_next.block[b] - it.x[k + 1].block[b];
    it.gap_sum += sum_magnitude(it.gap[k + 1]);
  }
  it.infeasibility = it.gap_sum + outside;
}

template <class L>
bool Solver<L>::backward(const Iterate<L>& it) {
  const int N = options.horizon;
  terminal_step(expansion(it, N), regularisation, factors[N]);
  for (int k = N - 1; k >= 0; --k)
    if (!backward_step<L>(it.node[k], expansion(it, k), it.gap[k + 1], factors[k + 1], step, regularisation,
                          factors[k]))
      return false;
  return true;
}

template <class L>
void Solver<L>::forward(const Iterate<L>& it) {
  const int N = options.horizon;
  dx[0] = zero_row<L>();  // the first state is measured
  for (int k = 0; k < N; ++k) {
    du[k] = control_step(factors[k], dx[k]);
    dx[k + 1] = propagate<L>(it.node[k], step, dx[k], du[k], it.gap[k + 1]);
    costates[k + 1] = costate(factors[k + 1], dx[k + 1]);
  }
}

// Newton step of the current iterate; raises the regularisation while the recursion is not positive definite.
template <class L>
bool Solver<L>::newton_step(Report& report) {
  constexpr double largest_regularisation = 1e3;
  for (;;) {
    ++report.factorisations;
    if (backward(current())) {
      forward(current());
      return true;
    }
    regularisation = larger(10 * regularisation, 1e-9);
    if (regularisation > largest_regularisation) return false;
  }
}

// Torque and force of a stage, linearised at the current direction.
template <class L>
void Solver<L>::bounded_values(const Iterate<L>& it, int k, BoundValues& values) const {
  const bool running = k < options.horizon;
  values.torque = running ? it.u[k] + du[k] : zero();
  const int rows = bounds[k].cone ? larger(bounds[k].forces, 3) : bounds[k].forces;
  for (int c = 0; c < rows; ++c) {
    Row<L> row_x;
    Lanes row_u;
    force_row(it.node[k], c, row_x, row_u);
    values.force[c] = it.node[k].force[c] + dot(row_x, dx[k]) + (running ? sum(row_u * du[k]) : 0);
  }
}

// Brings the terms' local model to the current direction; returns by how much the old one was wrong there.
template <class L>
DualError Solver<L>::model_error(const Iterate<L>& it) {
  DualError error;
  for (int k = 0; k <= options.horizon; ++k) {
    bounded_values(it, k, from_values[k]);
    const BoundValues& at = from_values[k];
    BoundVector predicted;
    predicted_gradient(bounds[k], terms[k], at.torque, at.force, predicted);
    bound_terms(bounds[k], multipliers[k], at.torque, at.force, terms[k]);
    error.add(bounds[k], predicted, terms[k].gradient);
  }
  return error;
}

// y ← gradient of the terms; returns the primal-dual residual ‖z − Π_C(z + y/ρ)‖ that the old y left.
template <class L>
double Solver<L>::update_multipliers() {
  double worst = 0;
  for (int k = 0; k <= options.horizon; ++k) {
    worst = larger(worst, largest_difference(bounds[k], multipliers[k], terms[k].gradient) / penalty);
    multipliers[k] = terms[k].gradient;
    bound_terms(bounds[k], multipliers[k], terms[k].torque_at, terms[k].force_at, terms[k]);
  }
  return worst;
}

// Goes from the direction before a Newton step to the best on the way to the new one; returns the share of the way.
template <class L>
double Solver<L>::search_direction(const Iterate<L>& it) {
  const int N = options.horizon;
  double begin = 0, end = 0;  // slope of the cost
  for (int k = 0; k <= N; ++k) {
    bounded_values(it, k, to_values[k]);
    Row<L> step_x = dx[k];
    add_scaled(step_x, from_x[k], -1);
    const Lanes none = zero(), before = k < N ? from_u[k] : none, after = k < N ? du[k] : none;
    const Expansion<L>& cost = it.node[k];
    begin += cost_slope(cost, regularisation, from_x[k], before, step_x, after - before);
    end += cost_slope(cost, regularisation, dx[k], after, step_x, after - before);
  }
  const double share = best_share([&](double s) {
    double slope = begin + s * (end - begin);
    for (int k = 0; k <= N; ++k) slope += term_slope(bounds[k], multipliers[k], from_values[k], to_values[k], s);
    return slope;
  });
  for (int k = 0; k <= N && share < 1; ++k) {
    scale(dx[k], share);
    add_scaled(dx[k], from_x[k], 1 - share);
    if (k < N) du[k] = from_u[k] * (1 - share) + du[k] * share;
  }
  return share;
}

// Direction under the bounds, by the method of bounds.hpp.
template <class L>
bool Solver<L>::bounded_step(double tolerance, Report& report) {
  constexpr int most_factorisations = 60;
  const Iterate<L>& it = current();
  const int N = options.horizon;
  for (int k = 0; k <= N; ++k) {
    dx[k] = zero_row<L>();
    if (k < N) du[k] = zero();
  }
  model_error(it);
  for (int i = 0; i < most_factorisations; ++i) {
    for (int k = 0; k <= N; ++k)
      bounded_expansion(bounds[k], terms[k], it.node[k], k < N ? it.u[k] : zero(), expansions[k]);
    for (int k = 0; k <= N; ++k) {
      from_x[k] = dx[k];
      if (k < N) from_u[k] = du[k];
    }
    if (!newton_step(report)) return false;
    const bool whole = i == 0 || search_direction(it) == 1;  // the first step closes the gaps of the dynamics
    if (!model_error(it).small() || !whole) continue;        // the active set moved
    if (update_multipliers() <= tolerance) break;            // within the bounds
  }
  return true;
}

// ∞-norm of the KKT residual with the multipliers of the last direction.
template <class L>
double Solver<L>::optimality(const Iterate<L>& it) const {
  const int N = options.horizon;
  double worst = 0;
  for (int k = 0; k < N; ++k) {
    Row<L> by_x;
    Lanes by_u;
    times_tangent<L>(costates[k + 1], it.node[k], step, by_x, by_u);
    if (options.bounds) {
      add_multipliers(bounds[k], multipliers[k], it.node[k], by_x, by_u);
      BoundTerms at;
      bound_terms(bounds[k], multipliers[k], it.u[k], it.node[k].force, at);
      worst = larger(worst, largest_difference(bounds[k], multipliers[k], at.gradient) / penalty);
    }
    worst = larger(worst, largest(absolute(by_u + it.node[k].Lu)));
    if (k > 0) {
      for (int b = 0; b < L::blocks; ++b) by_x.block[b] += it.node[k].Lx.block[b] - costates[k].block[b];
      worst = larger(worst, largest_magnitude(by_x));
    }
    worst = larger(worst, largest_magnitude(it.gap[k + 1]));
  }
  Row<L> last = it.node[N].Lx;
  if (options.bounds) {
    Lanes none = zero();
    add_multipliers(bounds[N], multipliers[N], it.node[N], last, none);
    BoundTerms at;
    bound_terms(bounds[N], multipliers[N], none, it.node[N].force, at);
    worst = larger(worst, largest_difference(bounds[N], multipliers[N], at.gradient) / penalty);
  }
  for (int b = 0; b < L::blocks; ++b) last.block[b] -= costates[N].block[b];
  return larger(worst, largest_magnitude(last));
}

// Filter of Fletcher and Leyffer: not dominated in cost and infeasibility by a recent iterate.
template <class L>
bool Solver<L>::acceptable(const Iterate<L>& trial, int iteration) const {
  if (!isfinite(trial.cost) || !isfinite(trial.infeasibility)) return false;
  const int kept = iteration + 1 < options.filter_size ? iteration + 1 : options.filter_size;
  for (int i = 0; i < kept; ++i) {
    const int slot = (iteration - i) % options.filter_size;
    if (filter_cost[slot] <= trial.cost && filter_infeasibility[slot] <= trial.infeasibility) return false;
  }
  return true;
}

template <class L>
bool Solver<L>::line_search(int iteration, Report& report) {
  const int N = options.horizon;
  const Iterate<L>& from = current();
  Iterate<L>& trial = iterates[1 - active];
  filter_cost[iteration % options.filter_size] = from.cost;
  filter_infeasibility[iteration % options.filter_size] = from.infeasibility;
  double length = 1;
  for (int attempt = 0; attempt < options.line_search_steps; ++attempt, length *= 0.5) {
    for (int k = 0; k <= N; ++k) {
      trial.x[k] = from.x[k];
      add_scaled(trial.x[k], dx[k], length);
      if (k < N) trial.u[k] = from.u[k] + du[k] * length;
    }
    evaluate(trial);
    ++report.evaluations;
    if (acceptable(trial, iteration)) {
      active = 1 - active;
      return true;
    }
  }
  return false;
}

template <class L>
Status Solver<L>::iterate(const Limits& limits, double start, Report& report) {
  int failures = 0;
  for (;;) {
    const bool found = options.bounds ? bounded_step(0.1 * limits.tolerance, report) : newton_step(report);
    if (!found) return Status::not_positive_definite;
    if (report.iterations == 0) report.kkt = optimality(current());
    if (!isfinite(report.kkt)) return Status::nan;
    if (report.kkt <= limits.tolerance) return Status::converged;
    if (report.iterations >= limits.max_iterations) return Status::max_iterations;
    if (line_search(report.iterations, report)) {
      failures = 0;
      regularisation = larger(0.1 * regularisation, options.regularisation);
    } else {
      if (++failures == 3) return Status::line_search;
      regularisation = larger(100 * regularisation, 1e-7);
    }
    ++report.iterations;
    report.kkt = optimality(current());  // with the multipliers of this step: no further factorisation if it suffices
    if (report.kkt <= limits.tolerance) return Status::converged;
    if (report.iterations >= limits.max_iterations) return Status::max_iterations;
    if (limits.time_budget >= 0 && now_seconds() - start > limits.time_budget) return Status::time_budget;
  }
}

template <class L>
void Solver<L>::solve(const NodeData* nodes, const double* x0, const Limits& limits, Report& report) {
  const double start = now_seconds();
  report = {};
  regularisation = options.regularisation;
  const Row<L> first = map.pack(x0);
  report.status = Status::nan;
  if (finite(first)) {
    if (model.disc.exponential) freeze(mat(nodes[0].task_rotation), first.block[0] * chain.is_joint);
    for (int k = 0; k <= options.horizon; ++k) prepare(nodes, k);
    Iterate<L>& it = current();
    it.x[0] = first;
    evaluate(it);
    report.evaluations = 1;
    if (isfinite(it.cost) && isfinite(it.infeasibility)) report.status = iterate(limits, start, report);
  }
  report.cost = current().cost;
  report.gap = current().gap_sum;
  report.violation = current().violation;
  report.seconds = now_seconds() - start;
}

}  // namespace pliant::mpc::PLIANT_ISA
