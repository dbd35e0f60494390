// A signed distance sampled on a grid, with a continuous gradient between the samples.
#pragma once

#include <array>
#include <cmath>

#include "../shared/vec3.hpp"

namespace pliant::contact {

struct Distance {
  double value;   // m, negative inside
  Vec3 gradient;  // not of unit length in general
  bool known;     // false outside the grid
};

// Samples at low + step (i, j, k), the last index runs fastest. Nothing here owns memory.
struct Field {
  Vec3 low;
  double step;
  std::array<int, 3> count;
  const double* values;

  Distance at(const Vec3& point) const;
};

// Four weights of a cubic through two neighbours with the slopes of central differences, and their derivatives: the
// curve and its tangent are continuous from cell to cell (Catmull and Rom 1974).
struct Cubic {
  explicit Cubic(double t)
      : weight{t * (-0.5 + t * (1.0 - 0.5 * t)), 1.0 + t * t * (-2.5 + 1.5 * t), t * (0.5 + t * (2.0 - 1.5 * t)),
               t * t * (0.5 * t - 0.5)},
        slope{-0.5 + t * (2.0 - 1.5 * t), t * (-5.0 + 4.5 * t), 0.5 + t * (4.0 - 4.5 * t), t * (1.5 * t - 1.0)} {}
  double weight[4], slope[4];
};

inline Distance Field::at(const Vec3& point) const {
  int cell[3];
  double within[3];
  for (int i = 0; i < 3; ++i) {
    const double place = (point[i] - low[i]) / step;
    if (!(place >= 1.0 && place < count[i] - 2)) return {HUGE_VAL, {}, false};
    cell[i] = static_cast<int>(place);
    within[i] = place - cell[i];
  }
  const Cubic x(within[0]), y(within[1]), z(within[2]);
  Distance found{0.0, {}, true};
  for (int i = 0; i < 4; ++i) {
    double plain = 0.0, along_y = 0.0, along_z = 0.0;
    for (int j = 0; j < 4; ++j) {
      const size_t row = static_cast<size_t>(cell[0] + i - 1) * count[1] + static_cast<size_t>(cell[1] + j - 1);
      const double* v = values + row * count[2] + static_cast<size_t>(cell[2] - 1);
      const double sum = z.weight[0] * v[0] + z.weight[1] * v[1] + z.weight[2] * v[2] + z.weight[3] * v[3];
      const double rise = z.slope[0] * v[0] + z.slope[1] * v[1] + z.slope[2] * v[2] + z.slope[3] * v[3];
      plain += y.weight[j] * sum;
      along_y += y.slope[j] * sum;
      along_z += y.weight[j] * rise;
    }
    found.value += x.weight[i] * plain;
    found.gradient.x += x.slope[i] * plain;
    found.gradient.y += x.weight[i] * along_y;
    found.gradient.z += x.weight[i] * along_z;
  }
  found.gradient = (1.0 / step) * found.gradient;
  return found;
}

}  // namespace pliant::contact
