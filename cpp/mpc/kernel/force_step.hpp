// One step of the visco-elastic force state, per contact axis, in the mean task acceleration ẍ of the step:
//     λ⁺ = λ − dt (velocity ẋ + acceleration ẍ + force λ)
//     mean force on the robot = λ + mean_velocity ẋ + mean_acceleration ẍ + mean_force λ
// Explicit Euler [FFMPC eq. 18, 24] is (K, B, 0) and (0, 0, 0). The exponential rule solves
//     ẍ = W λ + c,  λ̇ = −K ẋ − B ẍ,  c constant over the step,
// exactly for a frozen inverse task inertia W (the φ-functions of exponential integrators, Hochbruck and Ostermann,
// "Exponential integrators", Acta Numerica 2010), and eliminates c.
#pragma once
#include "../problem.hpp"
#include "simd.hpp"

namespace pliant::mpc::PLIANT_ISA {

struct ForceStep {
  double velocity, acceleration, force;
  double mean_velocity, mean_acceleration, mean_force;
};

struct Two {  // 2×2 matrix
  double a, b, c, d;
};
inline Two operator*(const Two& x, const Two& y) {
  return {x.a * y.a + x.b * y.c, x.a * y.b + x.b * y.d, x.c * y.a + x.d * y.c, x.c * y.b + x.d * y.d};
}
inline Two operator+(const Two& x, const Two& y) { return {x.a + y.a, x.b + y.b, x.c + y.c, x.d + y.d}; }
inline Two operator*(const Two& x, double s) { return {x.a * s, x.b * s, x.c * s, x.d * s}; }

// φ₁(Z) = Σ Zᵏ/(k+1)!, φ₂(Z) = Σ Zᵏ/(k+2)! by scaling, series and doubling.
inline void phi_functions(Two Z, Two& phi1, Two& phi2) {
  const Two one = {1, 0, 0, 1};
  const double norm = larger(magnitude(Z.a) + magnitude(Z.b), magnitude(Z.c) + magnitude(Z.d));
  int doublings = 0;
  double scale = 1;
  while (norm * scale > 0.25 && doublings < 60) {
    scale *= 0.5;
    ++doublings;
  }
  Z = Z * scale;
  phi2 = one * 0.5;
  Two power = one;
  double factorial = 2;
  for (int k = 1; k <= 10; ++k) {
    power = power * Z;
    factorial *= k + 2;
    phi2 = phi2 + power * (1 / factorial);
  }
  phi1 = one + Z * phi2;
  for (int i = 0; i < doublings; ++i) {
    const Two exponential = one + Z * phi1;
    phi2 = (phi1 * phi1 + phi2 * 2) * 0.25;
    phi1 = (phi1 + exponential * phi1) * 0.5;
    Z = Z * 2;
  }
}

inline ForceStep euler_step(double K, double B) { return {K, B, 0, 0, 0, 0}; }

inline ForceStep exponential_step(double K, double B, double W, double dt) {
  // Unit: scale the force by sqrt(K/W) so that both rows of the matrix have the size of the contact's frequency.
  const double s = W > 0 ? sqrt(K / W) : 1;
  Two phi1, phi2;
  phi_functions(Two{0, W * s * dt, -K / s * dt, -B * W * dt}, phi1, phi2);
  const double f11 = phi1.a, f12 = phi1.b / s, f21 = phi1.c * s, f22 = phi1.d;
  const double g1 = phi2.a - phi2.b / s * B, g2 = phi2.c * s - phi2.d * B;  // φ₂ (1, −B)
  const double implicit = 1 / (1 + dt * g2 * W);
  ForceStep step;
  step.mean_velocity = f21 * implicit;
  step.mean_force = f22 * implicit - 1;
  step.mean_acceleration = dt * g2 * implicit;
  step.velocity = K * (f11 - dt * g1 * W * step.mean_velocity);
  step.force = K * (f12 - dt * g1 * W * (1 + step.mean_force));
  step.acceleration = B + K * dt * g1 * (1 - W * step.mean_acceleration);
  return step;
}

}  // namespace pliant::mpc::PLIANT_ISA
