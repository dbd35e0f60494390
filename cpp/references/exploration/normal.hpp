// Estimates the normal of a contact from its force.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>

namespace pliant::references {

using Direction = std::array<double, 3>;

inline double dot(const Direction& a, const Direction& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// Rounded once, as Python's `math.hypot` nearly always is.
inline double length_of(const Direction& a) {
  const long double x = a[0], y = a[1], z = a[2];
  return double(std::sqrt(x * x + y * y + z * z));
}

// Angle of two unit vectors, rad.
inline double angle_between(const Direction& a, const Direction& b) {
  return std::acos(std::min(std::max(dot(a, b), -1.0), 1.0));
}

// The unit vector a fraction of the way from a to b; a if they are opposite.
inline Direction unit_blend(const Direction& a, const Direction& b, double share) {
  Direction mixed;
  for (int i = 0; i < 3; ++i) mixed[i] = a[i] + share * (b[i] - a[i]);
  const double length = std::sqrt(dot(mixed, mixed));
  if (length <= 1e-9) return a;
  for (double& part : mixed) part /= length;
  return mixed;
}

struct NormalRules {
  double least_force = 0.0;    // N, below it the force is not used
  double time_constant = 0.0;  // s
  double rate = 0.0;           // fastest turn, rad/s
  double cone = 0.0;           // rad, largest angle between the normal and the desired force
};

// Turns an estimated normal (unit, world axes, on the side of the robot) towards the direction given by the contact
// force, N, while the frame slides with a velocity, m/s.
//
// Friction acts against the sliding, so that the force without its part along the velocity is normal. At rest, stiction
// may have any direction within the friction cone, so that the estimate is not changed.
inline Direction turned_normal(const Direction& normal, const Direction& force, const Direction& velocity,
                               const NormalRules& rules, double period) {
  constexpr double kSliding = 5e-3;  // m/s; slower motion does not determine the direction of friction
  const double speed = length_of(velocity);
  if (speed < kSliding) return normal;
  const double along = dot(force, velocity) / (speed * speed);
  Direction seen;
  for (int i = 0; i < 3; ++i) seen[i] = force[i] - along * velocity[i];
  const double length = length_of(seen);
  if (length < rules.least_force) return normal;
  for (double& part : seen) part /= length;
  const double angle = angle_between(normal, seen);
  const double most = angle > 0.0 ? rules.rate * period / angle : 1.0;
  return unit_blend(normal, seen, std::min(period / (rules.time_constant + period), most));
}

// The normal, or the direction nearest to it within `half_angle`, rad, of the unit vector `axis`.
inline Direction within_cone(const Direction& normal, const Direction& axis, double half_angle) {
  const double angle = angle_between(axis, normal);
  if (angle <= half_angle) return normal;
  Direction across;
  for (int i = 0; i < 3; ++i) across[i] = normal[i] - std::cos(angle) * axis[i];
  const double length = length_of(across);
  if (length < 1e-9) return axis;
  const double s = std::sin(half_angle) / length, c = std::cos(half_angle);
  Direction found;
  for (int i = 0; i < 3; ++i) found[i] = c * axis[i] + s * across[i];
  return found;
}

}  // namespace pliant::references
