// log of a rotation and the matrix that maps a body angular velocity to the rate of the log.
#pragma once
#include "spatial.hpp"

namespace pliant::mpc::PLIANT_ISA {

struct RotationError {
  Vec log;       // e = log(E), E = R_refᵀ R [rad]
  Mat jacobian;  // ė = jacobian · ω in the axes of R (inverse right Jacobian of SO(3))
};

PLIANT_INLINE RotationError rotation_error(const Mat& reference, const Mat& R) {
  const Mat E = transposed(reference) * R;
  const Vec half = {0.5 * (E.m[7] - E.m[5]), 0.5 * (E.m[2] - E.m[6]), 0.5 * (E.m[3] - E.m[1])};  // axis · sin θ
  const double sin2 = dot(half, half), cosine = 0.5 * (E.m[0] + E.m[4] + E.m[8] - 1);
  double theta_over_sin, diagonal, outer;  // jacobian = diagonal 1 + outer e eᵀ + ½ e×
  Vec e;
  if (sin2 < 1e-8 && cosine > 0) {
    theta_over_sin = 1 + sin2 / 6;
    const double theta2 = sin2 * theta_over_sin * theta_over_sin;
    outer = 1.0 / 12 + theta2 / 720;
    diagonal = 1 - theta2 / 12;
    e = half * theta_over_sin;
  } else if (sin2 < 1e-8) {  // near π the sine loses the axis: take it from the symmetric part
    const double theta = 3.14159265358979323846 - sqrt(sin2);
    const double versine = 1 - cosine;
    const double d0 = E.m[0] - cosine, d1 = E.m[4] - cosine, d2 = E.m[8] - cosine;
    const int k = d0 >= d1 && d0 >= d2 ? 0 : d1 >= d2 ? 1 : 2;
    const double nk = sqrt(larger((k == 0 ? d0 : k == 1 ? d1 : d2) / versine, 0.0));
    const double share = 0.5 / (versine * nk);
    double n[3];
    for (int i = 0; i < 3; ++i) n[i] = i == k ? nk : (E.m[3 * i + k] + E.m[3 * k + i]) * share;
    const double sign = n[0] * half.x + n[1] * half.y + n[2] * half.z < 0 ? -1 : 1;
    e = vec(n) * (sign * theta);
    diagonal = 0.5 * theta * sqrt(sin2) / versine;
    outer = (1 - diagonal) / (theta * theta);
  } else {
    const double sine = sqrt(sin2), theta = atan2(sine, cosine);
    theta_over_sin = theta / sine;
    diagonal = 0.5 * theta * sine / (1 - cosine);
    outer = (1 - diagonal) / (theta * theta);
    e = half * theta_over_sin;
  }
  Mat Jm;
  const double v[3] = {e.x, e.y, e.z};
#pragma GCC unroll 3
  for (int i = 0; i < 3; ++i)
#pragma GCC unroll 3
    for (int j = 0; j < 3; ++j) Jm.m[3 * i + j] = outer * v[i] * v[j] + (i == j ? diagonal : 0);
  Jm.m[1] -= 0.5 * e.z;
  Jm.m[2] += 0.5 * e.y;
  Jm.m[3] += 0.5 * e.z;
  Jm.m[5] -= 0.5 * e.x;
  Jm.m[6] -= 0.5 * e.y;
  Jm.m[7] += 0.5 * e.x;
  return {e, Jm};
}

}  // namespace pliant::mpc::PLIANT_ISA
