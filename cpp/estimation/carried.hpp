// What a force/torque sensor carries and feels.
#pragma once
#include "../shared/vec3.hpp"

namespace pliant::estimation {

struct Load {
  double mass = 0;         // [kg]
  Vec3 center;             // in the sensor's axes [m]
  Vec3 force, moment;      // what the sensor reads without any load [N], [N·m]
  double inertia[9] = {};  // about the centre in the sensor's axes [kg m²]

  // Both together. The turning inertia of `other` counts about its own centre, which is right for a point.
  Load plus(const Load& other) const;
};

// How a sensor moves, in its own axes.
struct SensorMotion {
  Vec3 acceleration;  // of its origin minus gravity [m/s²]
  Vec3 spin;          // ω [rad/s]
  Vec3 turning;       // dω/dt [rad/s²]
};

// What a load makes the sensor read without any contact: Newton and Euler about the sensor's origin,
// f = −m (a + α × c + ω × (ω × c) − g), μ = c × f − I α − ω × I ω.
void reading_of(const Load& load, const SensorMotion& motion, Vec3& force, Vec3& moment);

}  // namespace pliant::estimation
