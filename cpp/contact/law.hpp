// The force of one contact point: a stiff spring and damper along the normal, a bristle that sticks across it.
#pragma once

#include <algorithm>
#include <cmath>

#include "../shared/vec3.hpp"

namespace pliant::contact {

struct Material {
  double stiffness;   // K, N/m
  double damping;     // D, N s/m
  double transition;  // m of penetration over which the force fades in
  double mu_static;
  double mu_dynamic;
  double critical_velocity;     // v_c, m/s of sliding at which friction falls from static to dynamic
  double tangential_stiffness;  // N/m of the bristle; 0 leaves a capped viscous friction, which creeps
  double tangential_damping;    // N s/m of the bristle
};

// The material of one of several points that press together.
inline Material shared(Material m, double share) {
  m.stiffness *= share;
  m.damping *= share;
  m.tangential_stiffness *= share;
  m.tangential_damping *= share;
  return m;
}

// Every number on the straight line from a to b.
inline Material between(const Material& a, const Material& b, double share) {
  Material m{};
  const auto *from = &a.stiffness, *to = &b.stiffness;
  double* into = &m.stiffness;
  for (size_t i = 0; i < sizeof(Material) / sizeof(double); ++i) into[i] = from[i] + share * (to[i] - from[i]);
  return m;
}

// Names of the fields in their order, for who fills a Material from a row of numbers.
constexpr const char* kMaterialNames[] = {
    "stiffness",  "damping",           "transition",           "mu_static",
    "mu_dynamic", "critical_velocity", "tangential_stiffness", "tangential_damping",
};
constexpr int kMaterialSize = sizeof(kMaterialNames) / sizeof(kMaterialNames[0]);
static_assert(sizeof(Material) == kMaterialSize * sizeof(double), "every number of a material has a name");

// Memory of one contact point.
struct Bristle {
  Vec3 deflection;     // m, in the tangent plane, of body A against body B
  double coefficient;  // friction coefficient in force now
  double sliding;      // 1 if the bristle gave way in the last step, else 0
};
constexpr int kBristleSize = 5;
static_assert(sizeof(Bristle) == kBristleSize * sizeof(double), "a bristle is a view of so many doubles");

// The coefficient follows its target with this time constant, divided by 1 + |v|/v_c. Without the lag, breaking away
// and sticking again alternate from one step to the next and the force has jumps of (mu_s - mu_d) F_n.
constexpr double kCoefficientTime = 1e-3;  // s

inline double smoothstep(double u) {
  u = std::clamp(u, 0.0, 1.0);
  return u * u * (3.0 - 2.0 * u);
}

// F_n = max(0, s(p / transition) (K p + D dp/dt)), N.
inline double normal_force(const Material& m, double penetration, double penetration_rate) {
  if (penetration <= 0.0) return 0.0;
  const double fade = m.transition > 0.0 ? smoothstep(penetration / m.transition) : 1.0;
  const double force = fade * (m.stiffness * penetration + m.damping * penetration_rate);
  return force < 0.0 ? 0.0 : force;  // written so that NaN passes through and is found
}

inline Vec3 capped(const Vec3& v, double length) {
  const double size = norm(v);
  return size > length ? (length / size) * v : v;
}

inline void reset(Bristle& b, const Material& m) { b = {{}, m.mu_static, 0.0}; }

// Coefficient towards which friction moves: static while the bristle holds, the Stribeck curve while it slides.
inline double target_coefficient(const Material& m, const Bristle& b, double speed) {
  if (b.sliding == 0.0) return m.mu_static;
  const double ratio = speed / m.critical_velocity;
  return m.mu_dynamic + (m.mu_static - m.mu_dynamic) * std::exp(-ratio * ratio);
}

// Friction on body A, N, and the bristle's next state. The bristle is an elastic-plastic spring: below the limit it
// only stretches, so a constant load creeps by nothing at all; at the limit it is carried along and dissipates.
inline Vec3 friction_force(const Material& m, const Vec3& normal, double force_normal, const Vec3& slip_velocity,
                           double dt, Bristle& b) {
  const Vec3 tangential = slip_velocity - dot(slip_velocity, normal) * normal;
  const double speed = norm(tangential);
  const double rate = (1.0 + speed / m.critical_velocity) / kCoefficientTime;
  b.coefficient += (target_coefficient(m, b, speed) - b.coefficient) * (1.0 - std::exp(-rate * dt));

  const double limit = b.coefficient * force_normal;
  b.deflection = b.deflection - dot(b.deflection, normal) * normal + dt * tangential;
  if (m.tangential_stiffness > 0.0) {
    const double reach = limit / m.tangential_stiffness;
    if (dt > 0.0) b.sliding = norm(b.deflection) > reach ? 1.0 : 0.0;
    b.deflection = capped(b.deflection, reach);
  }
  return capped(-m.tangential_stiffness * b.deflection - m.tangential_damping * tangential, limit);
}

}  // namespace pliant::contact
