// Direction of a step under bounds on torques and forces, by the method of bounds.hpp.
#pragma once
#include "sqp_direction.hpp"

namespace pliant::mpc::PLIANT_ISA {

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

}  // namespace pliant::mpc::PLIANT_ISA
