// The two formulas of SO(3) that a task needs. Matrices are row-major double[9].
#pragma once

#include <algorithm>
#include <cmath>

namespace pliant::impedance {

// log(A B^T), |log| in [0, pi]; near pi the axis comes from the symmetric part, where the antisymmetric one vanishes.
inline void log_difference(const double* A, const double* B, double* e) {
  double R[9];
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      R[3 * i + j] = A[3 * i] * B[3 * j] + A[3 * i + 1] * B[3 * j + 1] + A[3 * i + 2] * B[3 * j + 2];
    }
  }
  const double h[3] = {0.5 * (R[7] - R[5]), 0.5 * (R[2] - R[6]), 0.5 * (R[3] - R[1])};  // sin(angle) axis
  const double sine = std::sqrt(h[0] * h[0] + h[1] * h[1] + h[2] * h[2]);
  const double cosine = 0.5 * (R[0] + R[4] + R[8] - 1.0);
  const double angle = std::atan2(sine, cosine);
  if (cosine > -0.5) {
    const double scale = sine < 1e-4 ? 1.0 + sine * sine / 6.0 : angle / sine;
    for (int i = 0; i < 3; ++i) e[i] = scale * h[i];
    return;
  }
  int column = 0;
  double outer[9];
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      outer[3 * i + j] = (0.5 * (R[3 * i + j] + R[3 * j + i]) - (i == j ? cosine : 0.0)) / (1.0 - cosine);
    }
    if (outer[4 * i] > outer[4 * column]) column = i;
  }
  double axis[3], norm = 0.0, along = 0.0;
  for (int i = 0; i < 3; ++i) {
    axis[i] = outer[3 * i + column];
    norm += axis[i] * axis[i];
    along += axis[i] * h[i];
  }
  const double scale = (sine > 1e-12 && along < 0.0 ? -angle : angle) / std::sqrt(std::max(norm, 1e-300));
  for (int i = 0; i < 3; ++i) e[i] = scale * axis[i];
}

// R^T v and R v.
inline void into_axes(const double* R, const double* v, double* out) {
  for (int j = 0; j < 3; ++j) out[j] = R[j] * v[0] + R[3 + j] * v[1] + R[6 + j] * v[2];
}

inline void into_world(const double* R, const double* v, double* out) {
  for (int i = 0; i < 3; ++i) out[i] = R[3 * i] * v[0] + R[3 * i + 1] * v[1] + R[3 * i + 2] * v[2];
}

// J_l^-1(e) h; with sign = -1 its transpose J_r^-1(e) h.
inline void left_jacobian_inverse_times(const double* e, const double* h, double sign, double* m) {
  const double angle2 = e[0] * e[0] + e[1] * e[1] + e[2] * e[2];
  double gain = 1.0 / 12.0 + angle2 / 720.0;
  if (angle2 > 1e-4) {
    const double half = 0.5 * std::sqrt(angle2);
    gain = (1.0 - half * std::cos(half) / std::sin(half)) / angle2;
  }
  const double c[3] = {e[1] * h[2] - e[2] * h[1], e[2] * h[0] - e[0] * h[2], e[0] * h[1] - e[1] * h[0]};
  const double cc[3] = {e[1] * c[2] - e[2] * c[1], e[2] * c[0] - e[0] * c[2], e[0] * c[1] - e[1] * c[0]};
  for (int i = 0; i < 3; ++i) m[i] = h[i] - 0.5 * sign * c[i] + gain * cc[i];
}

}  // namespace pliant::impedance
