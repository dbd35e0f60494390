// One tick of one axis: book the last period, decide the phase, ask the law, ask the account.
#pragma once

#include "attractor.hpp"

namespace pliant::impedance {

struct AxisConfig {
  AttractorConfig attractor;
  AccountConfig account;
};

// How the axis is told about the last period.
struct AxisMotion {
  double robot;  // error with the target of the last tick
  double work;   // J that the force really sent took in from the robot; unused without an account
};

inline void push_error(AxisState& s, double error) {
  s.error_3 = s.error_2;
  s.error_2 = s.error;
  s.error = error;
}

// Books the work of the force held since the last tick. `absorbed` is the ledger's, the account has its own book.
inline void book_motion(const AxisConfig& c, Shape shape, const Axis& p, AxisState& s, double error,
                        const AxisMotion& m, double rate_floor) {
  s.absorbed += s.force * (error - s.error);
  if (c.account.active) book(c.account, shape, p, s.account, {s.error, m.robot, error, s.force, m.work});
  update_rate(c.attractor, s, error, rate_floor);
}

// Another branch of the logarithm, or another set of axes: no motion of the error. `by_target` says that the target
// made the change, and supplies what is stored more.
inline void restart(const AxisConfig& c, Shape shape, const Axis& p, AxisState& s, double error, double work,
                    bool by_target) {
  const double stored = energy(shape, p, error);
  s.injected += stored - energy(shape, p, s.error);
  s.error = s.error_2 = s.error_3 = error;
  s.rate = s.blend = 0.0;
  diverge(s, error);
  if (!c.account.active) return;
  AccountState& a = s.account;
  add(c.account, a, by_target ? work : work - (stored - a.stored));
  a.stored = stored;
  std::fill(a.steps, a.steps + kSteps, 0.0);
  a.target = a.expected = 0.0;
}

inline void retune(const AxisConfig& c, Shape shape, Axis& p, AxisState& s, double error, const Axis& tuned) {
  const double before = storage(c.attractor, shape, p, s, error);
  p = tuned;
  s.injected += storage(c.attractor, shape, p, s, error) - before;
  if (c.account.active) restate(c.account, s.account, energy(shape, p, error));
}

// J that a layer outside may spend until the next tick without making the axis active.
struct AxisForce {
  double threshold;
  double spendable;
};

// Phase, law, account; leaves the force in s.force.
inline AxisForce update_force(const AxisConfig& c, Shape shape, const Axis& p, AxisState& s, double error,
                              double rate_floor, bool rotates) {
  const double threshold = rate_threshold(c.attractor, s, rate_floor);
  const bool converged = s.converging != 0.0;
  update_phase(c.attractor, s, error, threshold);
  const double wanted = blended_force(c.attractor, shape, p, s, error, converged && s.converging == 0.0);
  if (!c.account.active) {
    s.force = wanted;
    return {threshold, 0.0};
  }
  const Budget b = budget(shape, p, s.account, error);
  s.force = allowed_force(c.account, p, s.account, b, wanted, rotates);
  return {threshold, c.account.spend * std::max(b.balance, 0.0) + s.account.savings};
}

}  // namespace pliant::impedance
