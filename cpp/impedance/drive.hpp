// One axis driven along given errors, for searches: the same tick as in the stack, with the target at rest.
#pragma once

#include "axis.hpp"

namespace pliant::impedance {

// errors (steps) with a stride, forces and balances (steps) with the same.
inline void drive(const AxisConfig& c, Shape shape, Axis p, double rate_floor, bool rotates, const double* errors,
                  double* forces, double* balances, int steps, std::ptrdiff_t stride) {
  AxisState s;
  for (int k = 0; k < steps; ++k) {
    const double error = errors[k * stride];
    if (k == 0) {
      start(s, shape, p, error, rate_floor, c.attractor);
      update_rate(c.attractor, s, error, rate_floor);
    } else {
      book_motion(c, shape, p, s, error, {error, s.force * (error - s.error)}, rate_floor);
      push_error(s, error);
    }
    update_force(c, shape, p, s, error, rate_floor, rotates);
    forces[k * stride] = s.force;
    balances[k * stride] = s.account.balance;
  }
}

}  // namespace pliant::impedance
