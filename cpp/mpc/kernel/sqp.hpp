// Stagewise sequential quadratic programming with a filter line search, after Jordana, Kleff, Meduri, Carpentier,
// Mansard and Righetti, "Stagewise implementations of sequential quadratic programming for model-predictive control"
// (2023). All memory is taken at construction.
#pragma once
#include "sqp_bounds.hpp"

namespace pliant::mpc::PLIANT_ISA {

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
