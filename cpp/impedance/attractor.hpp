// The fractal attractor of one axis: when it diverges, when it converges, which force it gives, and what it books.
#pragma once

#include "account.hpp"

namespace pliant::impedance {

enum class Law { Capped, HapFic, StackPrinted, StackCorrected, Spring };

struct AttractorConfig {
  Law law;
  double period;         // s
  double rate_gain;      // share of a new difference in the low-passed rate, 0..1
  double noise_gain;     // share of a new sample in the noise variance, 0..1
  double noise_to_rate;  // 1/s: std of the low-passed rate per std of a white error
  double hold_limit;     // s
  double blend_step;     // share of the step of the force, where convergence ends, that one period takes away
};

// State of one axis between two ticks; doubles only. `error_2`, `error_3` are the errors before `error`.
struct AxisState {
  double turning;     // x_m: error at which the current convergence started, or the current error
  double converging;  // 1 or 0
  double hold;        // s for which the rate was too small to tell the direction
  double error, error_2, error_3;
  double rate;      // low-passed d(error)/dt
  double noise;     // variance of the error's white noise
  double force;     // h of the last tick, held since
  double absorbed;  // J, integral of h d(error)
  double injected;  // J, by changes of the tuning
  double energy_start;
  double gap;    // force that was missing when convergence was left, N or N m
  double blend;  // share of it that is still missing, 1..0
  AccountState account;
};

// Rate and noise from differences of the error. The third difference of a smooth motion is negligible, that of white
// noise has 20 times its variance; outliers (a step of the reference, an impact) are clipped to three standard
// deviations.
inline void update_rate(const AttractorConfig& c, AxisState& s, double error, double rate_floor) {
  const double third = error - 3.0 * s.error + 3.0 * s.error_2 - s.error_3;
  const double deviation = rate_floor / (3.0 * c.noise_to_rate);
  const double floor = deviation * deviation;
  const double sample = std::min(third * third / 20.0, 9.0 * s.noise + floor);
  s.noise += c.noise_gain * (sample - s.noise);
  s.rate += c.rate_gain * ((error - s.error) / c.period - s.rate);
}

inline double rate_threshold(const AttractorConfig& c, const AxisState& s, double rate_floor) {
  return std::max(rate_floor, 3.0 * c.noise_to_rate * std::sqrt(s.noise));
}

inline void diverge(AxisState& s, double error) {
  s.converging = 0.0;
  s.turning = error;
}

inline void update_phase(const AttractorConfig& c, AxisState& s, double error, double threshold) {
  if (c.law == Law::Spring || error * s.turning <= 0.0 || std::fabs(error) >= std::fabs(s.turning)) {
    s.hold = 0.0;
    diverge(s, error);
    return;
  }
  const double outward = error > 0.0 ? s.rate : -s.rate;
  if (outward > threshold) {
    s.hold = 0.0;
    diverge(s, error);
  } else if (outward < -threshold) {
    s.hold = 0.0;
    s.converging = 1.0;
  } else {
    s.hold += c.period;
    if (s.converging == 0.0 || s.hold > c.hold_limit) diverge(s, error);
  }
}

inline double signed_force(Shape shape, const Axis& p, double error) {
  return std::copysign(magnitude(shape, p, std::fabs(error)), error);
}

inline double converging_force(Law law, Shape shape, const Axis& p, double error, double turning) {
  const double limit = std::fabs(turning);
  const double sign = std::copysign(1.0, turning);
  const double share = error / turning;
  if (law == Law::Capped) {
    const double m = std::max(share, 1.0 - share);
    const double cap = std::min(magnitude(shape, p, limit) * (2.0 * m - 1.0), magnitude(shape, p, m * limit));
    return share >= 0.5 ? sign * cap : -sign * cap;
  }
  if (law == Law::HapFic) return sign * magnitude(shape, p, limit) * (2.0 * share - 1.0);
  const double gain = 4.0 * energy(shape, p, turning) / (turning * turning);
  const double towards_target = gain * (error - 0.5 * turning);
  return law == Law::StackCorrected ? towards_target : -towards_target;
}

inline double law_force(const AttractorConfig& c, Shape shape, const Axis& p, const AxisState& s, double error) {
  if (s.converging == 0.0) return signed_force(shape, p, error);
  return converging_force(c.law, shape, p, error, s.turning);
}

// The force of the law, less what is still missing of the step that it makes where convergence ends. `left` says
// whether convergence ended at this tick; s.force is still the force of the last one.
inline double blended_force(const AttractorConfig& c, Shape shape, const Axis& p, AxisState& s, double error,
                            bool left) {
  const double law = law_force(c, shape, p, s, error);
  if (left) {
    s.gap = law - s.force;
    s.blend = 1.0;
  }
  s.blend = std::max(s.blend - c.blend_step, 0.0);
  return s.blend > 0.0 ? clamped(law - s.blend * s.gap, p.force_max) : law;
}

// Energy that can still leave the error port: E while diverging, E(x_m) minus what the convergence gave back so far.
inline double storage(const AttractorConfig& c, Shape shape, const Axis& p, const AxisState& s, double error) {
  const double span = s.turning - error;
  if (s.converging == 0.0 || error * s.turning <= 0.0 || std::fabs(error) >= std::fabs(s.turning)) {
    return energy(shape, p, error);
  }
  constexpr int kIntervals = 32;
  const double step = span / kIntervals;
  double work = 0.0;
  for (int i = 0; i < kIntervals; ++i) {
    work += step * converging_force(c.law, shape, p, error + (i + 0.5) * step, s.turning);
  }
  return energy(shape, p, s.turning) - work;
}

inline void start(AxisState& s, Shape shape, const Axis& p, double error, double rate_floor, const AttractorConfig& c) {
  s = AxisState{};
  s.turning = s.error = s.error_2 = s.error_3 = error;
  s.energy_start = s.account.stored = energy(shape, p, error);
  const double deviation = rate_floor / (3.0 * c.noise_to_rate);
  s.noise = deviation * deviation;
}

}  // namespace pliant::impedance
