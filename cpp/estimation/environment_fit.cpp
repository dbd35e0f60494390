#include "environment_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pliant::estimation {

void EnvironmentFit::step(double force, double depth, double rate, FitMemory& memory) const {
  if (force < settings_.touch) {
    const FitMemory before = memory;
    memory = {};
    memory.known = before.known;
    memory.found = before.found;
    return;
  }
  double value[3] = {depth, rate, force};
  if (memory.touching == 0) {
    memory.touching = 1;
    std::copy(value, value + 3, memory.reference);
    for (int i = 0; i < 3; ++i) memory.first[i] = memory.second[i] = memory.slow[i] = 0;
  }
  for (int i = 0; i < 3; ++i) value[i] -= memory.reference[i];
  settings_.filter.step(value, 3, memory.first, memory.second);
  for (int i = 0; i < 3; ++i) {
    memory.slow[i] += settings_.drift * (value[i] - memory.slow[i]);
    value[i] -= memory.slow[i];
  }
  if (informative(value, memory)) learn(value, memory);
}

bool EnvironmentFit::informative(const double* value, const FitMemory& memory) const {
  if (memory.used == 0) return true;
  return std::abs(value[2] - memory.accepted[2]) >= settings_.least_force &&
         std::abs(value[0] - memory.accepted[0]) >= settings_.least_motion;
}

void EnvironmentFit::learn(const double* value, FitMemory& memory) const {
  memory.count += 1;
  const double share = std::max(1 / memory.count, 1 / settings_.samples);
  double off[3];
  for (int i = 0; i < 3; ++i) {
    off[i] = value[i] - memory.mean[i];
    memory.mean[i] += share * off[i];
    memory.accepted[i] = value[i];
  }
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      memory.covariance[i][j] = (1 - share) * (memory.covariance[i][j] + share * (off[i] * off[j]));
  memory.used = 1;
  Environment found;
  if (memory.count >= settings_.least_samples && solve(memory, share, found)) {
    memory.known = 1;
    memory.found = found;
  }
}

// K and B with their uncertainties; false where the data do not tell K. A damping below zero is none, so depth and rate
// are tried first, then depth alone.
bool EnvironmentFit::solve(const FitMemory& memory, double share, Environment& found) const {
  const auto& covariance = memory.covariance;
  const double independent = std::min(memory.count, 2 / share - 1) / settings_.correlated;
  const double spread[2] = {covariance[0][0] - settings_.noise[0], covariance[1][1] - settings_.noise[1]};
  const double b[2] = {covariance[0][2], covariance[1][2]};
  for (const int columns : {2, 1}) {
    bool told = true;
    double scale[2] = {1, 1};
    for (int i = 0; i < columns; ++i) {
      scale[i] = std::sqrt(spread[i]);
      told = told && !(spread[i] < 2 * settings_.noise[i]) && scale[i] > 0;
    }
    if (!told) continue;
    // of the correlation matrix (1, r; r, 1), scaled back
    const double r = columns == 2 ? covariance[0][1] / (scale[0] * scale[1]) : 0;
    const double determinant = 1 - r * r;
    if (determinant < 1e-6) continue;
    double gains[2] = {0, 0}, inverse[2];
    for (int i = 0; i < columns; ++i) {
      inverse[i] = 1 / determinant / (scale[i] * scale[i]);
      gains[i] = inverse[i] * b[i];
      if (columns == 2) gains[i] -= r / determinant / (scale[0] * scale[1]) * b[1 - i];
    }
    if (gains[columns - 1] < 0) continue;
    const double residual = std::max(covariance[2][2] - (gains[0] * b[0] + gains[1] * b[1]), 0.0);
    const double freedom = std::max(independent - 3, 1.0);
    const double stiffness_std = std::sqrt(residual * inverse[0] / freedom);
    if (stiffness_std > settings_.accuracy * gains[0]) return false;
    found = {gains[0], 0, stiffness_std, std::numeric_limits<double>::infinity()};
    if (columns == 2) found = {gains[0], gains[1], stiffness_std, std::sqrt(residual * inverse[1] / freedom)};
    return true;
  }
  return false;
}

}  // namespace pliant::estimation
