#include "tare.hpp"

#include <algorithm>

namespace pliant::estimation {

Load tared(const TareSettings& tare, const Vec3& force, const Vec3& moment, const Vec3& gravity) {
  const double scale = dot(gravity, gravity);
  Load load;
  load.mass = !tare.weight || scale == 0 ? 0 : std::max(0.0, dot(force, gravity) / scale);
  load.force = force;
  load.moment = moment;
  if (load.mass == 0) return load;
  const Vec3 weight = load.mass * gravity;
  load.center = (1 / dot(weight, weight)) * cross(weight, moment);
  load.force = force - weight;
  load.moment = moment - cross(load.center, weight);
  return load;
}

void store(const Load& load, double* to) {
  to[0] = load.mass;
  store(load.center, to + 1);
  store(load.force, to + 4);
  store(load.moment, to + 7);
}

Load load_of(const double* from) {
  Load found;
  found.mass = from[0];
  found.center = load(from + 1);
  found.force = load(from + 4);
  found.moment = load(from + 7);
  return found;
}

}  // namespace pliant::estimation
