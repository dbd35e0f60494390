// The passivity account of one axis: what its sampled force took in beyond what the profile stores, and how much of
// that the next force may spend.
//
// Over a period the held force h takes in h d, with d the motion of the error, and the profile stores E(error). The
// difference is booked at the next tick, so that sampling, blending, clamps, step limits and changes of the tuning are
// paid from what was dissipated before. Where the account holds nothing, the next force may not let out more than the
// profile gives back over the step that is expected. A passivity observer and controller (Hannaford and Ryu 2002).
#pragma once

#include "profile.hpp"

namespace pliant::impedance {

struct AccountConfig {
  bool active;
  double period;         // s
  double deposit;        // share that is kept of an income beyond the debt
  double ceiling;        // J, largest balance
  double savings;        // J, most of what is beyond it that is put aside
  double spend;          // share of the balance beyond the reserve that one step may spend
  double damping;        // largest force that repays a debt, as a multiple of the slope times the step
  double tolerance;      // J, debt that does not weaken the axis
  double speed[2];       // m/s, rad/s: the tolerance is at least K_0/2 (speed period)^2
  double kick[2];        // m/s, rad/s: a step may come out otherwise than expected by so much times the period
  double trickle;        // W that an overdrawn axis may always let out
  double trust;          // share per period with which it is learned how right the expected steps are
  double peak_keep;      // share of the largest recent step and slope that is kept per period
  double surprise_keep;  // share of the largest recent surprise that is kept per period
  double forgiveness;    // share of the debt beyond the tolerance that is written off per period
};

// What Python hands over, in the order of AccountConfig's fields after the period.
constexpr const char* kAccountNames[] = {
    "deposit", "ceiling",      "savings", "spend", "damping",   "tolerance",     "speed",       "speed_angular",
    "kick",    "kick_angular", "trickle", "trust", "peak_keep", "surprise_keep", "forgiveness",
};
constexpr int kAccountNumbers = sizeof(kAccountNames) / sizeof(kAccountNames[0]);

// So many periods back it is looked for a step that comes again.
constexpr int kSteps = 6;

// State of one axis between two ticks; doubles only.
struct AccountState {
  double balance;         // J taken in beyond what is stored
  double savings;         // J put aside for what comes from outside: changes of the tuning, torque that was not sent
  double stored;          // J, E of the error
  double steps[kSteps];   // by which the error moved in the last periods, newest first, targets that jump left out
  double misses[kSteps];  // recent mean square of what each guess of a step was off
  double target;          // by which the target moved the error in the last period
  double peak;            // largest recent step
  double expected;        // step that was expected for the period that follows
  double surprise;        // largest recent difference of a step to what was expected
  double right;           // recent mean of the expected step times the real one
  double size;            // of its absolute value
  double slope;           // largest recent slope of the profile over a step, at least K_0, N/m or N m/rad
};

// What moved the error in the last period.
struct Motion {
  double from;   // the error before
  double robot;  // after the robot moved, with the target where it was
  double error;  // after the target moved, too
  double force;  // h that was asked for in the period
  double work;   // J that the force that was really sent took in from the robot, h times its motion or not
};

inline double smaller_of_a_kind(double a, double b) {
  if (a * b <= 0.0) return 0.0;
  return std::fabs(a) < std::fabs(b) ? a : b;
}

// An income pays the debt first; of what is left a share is kept.
inline void add(const AccountConfig& c, AccountState& a, double income) {
  const double debt = std::min(std::max(-a.balance, 0.0), std::max(income, 0.0));
  a.balance += income > 0.0 ? debt + c.deposit * (income - debt) : income;
  const double beyond = std::max(a.balance - c.ceiling, 0.0);
  a.balance -= beyond;
  a.savings = std::min(a.savings + beyond, c.savings);
}

// An income from outside; a cost is taken from the savings first. The force of the axis itself never draws on them.
inline void add_outside(const AccountConfig& c, AccountState& a, double income) {
  const double paid = std::min(std::max(-income, 0.0), a.savings);
  a.savings -= paid;
  add(c, a, income + paid);
}

// What the next step could be: the last change goes on, or the step of i + 1 periods before comes again.
inline double guess(const AccountState& a, int i) {
  if (i > 0) return a.steps[i];
  const double size = std::max(std::fabs(a.steps[0]), std::fabs(a.steps[1]));
  return std::min(std::max(2.0 * a.steps[0] - a.steps[1], -size), size);
}

// That what was repeated comes again is believed only where it was the better guess by far.
inline double likely_step(const AccountState& a) {
  int best = 0;
  double least = 0.5 * a.misses[0];
  for (int i = 1; i < kSteps; ++i) {
    if (a.misses[i] >= least) continue;
    least = a.misses[i];
    best = i;
  }
  return guess(a, best);
}

inline void learn(const AccountConfig& c, AccountState& a, double step) {
  for (int i = 0; i < kSteps; ++i) {
    const double miss = step - guess(a, i);
    a.misses[i] += c.trust * (miss * miss - a.misses[i]);
  }
  std::copy_backward(a.steps, a.steps + kSteps - 1, a.steps + kSteps);
  a.steps[0] = step;
  a.surprise = std::max(std::fabs(a.expected - step), a.surprise * c.surprise_keep);
  a.right += c.trust * (a.expected * step - a.right);
  a.size += c.trust * (std::fabs(a.expected * step) - a.size);
}

// Books the last period. A target that moves the error by r supplies h r, or what the profile stores more if that is
// more.
inline void book(const AccountConfig& c, Shape shape, const Axis& p, AccountState& a, const Motion& m) {
  const double stored = energy(shape, p, m.error);
  const double target = m.error - m.robot;
  const double between = target == 0.0 ? stored : energy(shape, p, m.robot);
  const double own = m.force * (m.robot - m.from);
  add_outside(c, a, m.work - own);
  add(c, a, own - (between - a.stored) + std::max(m.force * target - (stored - between), 0.0));
  learn(c, a, m.robot - m.from + smaller_of_a_kind(target, a.target));
  a.target = target;
  a.stored = stored;
}

// What the profile stores more after a change of the tuning is taken from savings and balance as far as they go: the
// rest was supplied by who made the change, and leaves no debt.
inline void restate(const AccountConfig& c, AccountState& a, double stored) {
  const double income = a.stored - stored;
  add_outside(c, a, std::max(income, -a.savings - std::max(a.balance, 0.0)));
  a.stored = stored;
  a.slope = 0.0;
}

constexpr double kSmallStep = 1e-6;  // m or rad: below it the difference of energies is rounding

// What is left to spend on a step d: the balance less what a reversal would cost.
struct Budget {
  double step;     // that is expected
  double slope;    // of the profile over it there and back, N/m or N m/rad
  double gain;     // J that the profile stores more after it
  double balance;  // J, beyond the reserve; negative: below it
};

inline Budget budget(Shape shape, const Axis& p, const AccountState& a, double error) {
  const double d = likely_step(a);
  if (d == 0.0) return {0.0, 0.0, 0.0, a.balance};
  const double gain = energy(shape, p, error + d) - a.stored;
  const double reversal = gain + energy(shape, p, error - d) - a.stored;
  const double slope = std::fabs(d) > kSmallStep ? reversal / (d * d) : 0.0;
  return {d, slope, gain, a.balance - std::max(reversal, 0.0)};
}

inline double clamped(double x, double bound) { return std::min(std::max(x, -bound), bound); }

// J that may still leave the axis, what is stored included.
inline double left(const AccountState& a, double tolerance) { return a.stored + a.balance + tolerance; }

// However the next step comes out, within what surprised of late, what leaves is left. After a debt the largest recent
// step counts, whichever way it went.
inline double bounded_by_rest(const AccountConfig& c, const AccountState& a, double tolerance, double step, double h,
                              bool rotates) {
  const double least = c.trickle * c.period;
  const double against = std::max(c.kick[rotates] * c.period, a.surprise) - (h > 0.0 ? step : -step);
  if (against > 0.0) h = clamped(h, std::max(left(a, tolerance), least) / against);
  if (a.balance < 0.0 && a.peak > 0.0) h = clamped(h, std::max(0.5 * left(a, tolerance), least) / a.peak);
  return h;
}

// The force nearest to the wanted one that the account allows.
inline double allowed_force(const AccountConfig& c, const Axis& p, AccountState& a, const Budget& b, double h,
                            bool rotates) {
  a.expected = b.step;
  a.slope = std::max(std::max(b.slope, p.stiffness), a.slope * c.peak_keep);
  const double right = a.size > 0.0 ? std::max(a.right / a.size, 0.0) : 1.0;
  if (b.step != 0.0) {
    const double repay = std::min(std::max(-b.balance, 0.0), right * c.damping * a.slope * b.step * b.step);
    const double need = b.gain - c.spend * std::max(b.balance, 0.0) + repay;
    if (h * b.step < need) h = need / b.step;
    h = clamped(h, p.force_max);
  }
  const double way = c.speed[rotates] * c.period;
  const double tolerance = std::max(c.tolerance, 0.5 * p.stiffness * way * way);
  a.balance += c.forgiveness * std::max(-left(a, tolerance), 0.0);
  a.peak = std::max(std::fabs(a.steps[0]), a.peak * c.peak_keep);
  return bounded_by_rest(c, a, tolerance, b.step, h, rotates);
}

}  // namespace pliant::impedance
