// Newton direction of the current iterate by the Riccati recursion.
#pragma once
#include "solver.hpp"

namespace pliant::mpc::PLIANT_ISA {

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

}  // namespace pliant::mpc::PLIANT_ISA
