#include "carried.hpp"

namespace pliant::estimation {

Load Load::plus(const Load& other) const {
  Load both = *this;
  both.mass = mass + other.mass;
  if (other.mass != 0) both.center = (1 / both.mass) * (mass * center + other.mass * other.center);
  both.force = force + other.force;
  both.moment = moment + other.moment;
  return both;
}

void reading_of(const Load& load, const SensorMotion& motion, Vec3& force, Vec3& moment) {
  const double* I = load.inertia;
  const auto turned = [I](const Vec3& x) {
    return Vec3{I[0] * x.x + I[1] * x.y + I[2] * x.z, I[3] * x.x + I[4] * x.y + I[5] * x.z,
                I[6] * x.x + I[7] * x.y + I[8] * x.z};
  };
  const Vec3 at_center =
      motion.acceleration + cross(motion.turning, load.center) + cross(motion.spin, cross(motion.spin, load.center));
  const Vec3 pull = -load.mass * at_center;
  force = pull + load.force;
  moment = cross(load.center, pull) - turned(motion.turning) - cross(motion.spin, turned(motion.spin)) + load.moment;
}

}  // namespace pliant::estimation
