// Force profiles of a fractal impedance axis: the force and the energy that an error stores.
#pragma once

#include <algorithm>
#include <cmath>

namespace pliant::impedance {

enum class Shape { Exponential, Tanh, ExponentialPrinted, TanhPrinted };

// One axis. Plain doubles, so that it can live in a flat state array.
struct Axis {
  double stiffness;     // K_0, N/m or N m/rad
  double force_max;     // F_max, N or N m
  double range;         // x_b, m or rad
  double linear_range;  // x_0, m or rad
  double knee_force;    // F_0 = K_0 x_0
  double rise;          // F_max - F_0
  double length;        // characteristic length of the bend, m or rad
};

constexpr double kSteepness = 20.0;    // S of Tiseo et al. 2020, sec. II-C
constexpr double kPrintedRise = 1.0;   // N or N m: what stands for F_max - F_0 in the print of its eq. 3
constexpr double kPrintedS = 0.1353;   // S of Tiseo et al. 2021, eq. 4
constexpr double kPrintedKnee = 0.95;  // share of x_b at which the linear part ends there
constexpr double kPi = 3.14159265358979323846;
constexpr double kTanhPi = 0.99627207622074994;  // tanh(pi)

inline double log_cosh(double z) {
  const double a = std::fabs(z);  // the naive form overflows at 710
  return a + std::log1p(std::exp(-2.0 * a)) - 0.69314718055994531;
}

inline Axis make_axis(Shape shape, double stiffness, double force_max, double range, double linear_range) {
  const double knee = shape == Shape::TanhPrinted ? kPrintedKnee * range : linear_range;
  Axis axis{stiffness, force_max, range, knee, stiffness * knee, 0.0, 1.0};
  axis.rise = std::max(force_max - axis.knee_force, 0.0);
  if (shape == Shape::ExponentialPrinted) axis.rise = std::min(axis.rise, kPrintedRise);
  const double bend = range - knee;
  if (bend <= 0.0) return axis;
  if (shape == Shape::Tanh) {
    axis.length = bend / (2.0 * kPi);
  } else {
    axis.length = shape == Shape::TanhPrinted ? kPrintedS * range : bend / kSteepness;
  }
  return axis;
}

// |F| at a distance |error| = a.
inline double magnitude(Shape shape, const Axis& p, double a) {
  if (a <= p.linear_range) return std::min(p.stiffness * a, p.force_max);
  const double beyond = a - p.linear_range;
  if (shape == Shape::ExponentialPrinted && a >= p.range) return p.force_max;
  if (shape == Shape::Exponential || shape == Shape::ExponentialPrinted) {
    return p.knee_force - p.rise * std::expm1(-beyond / p.length);
  }
  const double z = (a - p.range) / p.length + kPi;
  if (shape == Shape::TanhPrinted) return p.knee_force + 0.5 * p.rise * (std::tanh(z) + 1.0);
  return p.knee_force + p.rise * (std::tanh(z) + kTanhPi) / (1.0 + kTanhPi);
}

inline double energy(Shape shape, const Axis& p, double error) {
  const double a = std::fabs(error);
  if (a <= p.linear_range) return 0.5 * p.stiffness * a * a;
  const double beyond = a - p.linear_range;
  const double linear = 0.5 * p.stiffness * p.linear_range * p.linear_range;
  if (shape == Shape::Exponential || shape == Shape::ExponentialPrinted) {
    const bool past = shape == Shape::ExponentialPrinted && a > p.range;
    const double bent = past ? p.range - p.linear_range : beyond;
    return linear + (p.knee_force + p.rise) * bent + p.length * p.rise * std::expm1(-bent / p.length) +
           p.force_max * (beyond - bent);
  }
  const double z = (a - p.range) / p.length + kPi;
  if (shape == Shape::TanhPrinted) {
    const double first = (p.linear_range - p.range) / p.length + kPi;
    return linear + p.knee_force * beyond + 0.5 * p.rise * (p.length * (log_cosh(z) - log_cosh(first)) + beyond);
  }
  return linear + p.knee_force * beyond +
         p.rise / (1.0 + kTanhPi) * (p.length * (log_cosh(z) - log_cosh(kPi)) + kTanhPi * beyond);
}

}  // namespace pliant::impedance
