// Sine and cosine of all lanes at once: reduction to |r| ≤ π/4 with π/2 in three pieces (Cody and Waite), then the
// minimax polynomials of the freely distributable libm. Error below 2 units in the last place for |x| < 1e5 rad.
#pragma once
#include "simd.hpp"

namespace pliant::mpc::PLIANT_ISA {

struct SinCos {
  Lanes sin, cos;
};

PLIANT_INLINE SinCos sine_cosine(const Lanes& x) {
  constexpr double two_over_pi = 6.36619772367581382433e-01;
  constexpr double half_pi_1 = 1.57079632673412561417e+00;  // leading 33 bits, so that quadrant · half_pi_1 is exact
  constexpr double half_pi_2 = 6.07710050630396597660e-11;
  constexpr double half_pi_3 = 2.02226624879595063154e-21;
  constexpr double round_to_int =
      6755399441055744.0;  // 1.5 · 2^52: adding it leaves the nearest integer in the low bits
  SinCos out;
  PLIANT_EACH_PART {
    const Native shifted = x.part[k] * two_over_pi + round_to_int;
    const Native quadrant = shifted - round_to_int;
    const NativeMask bits = (NativeMask)shifted;
    const Native r = ((x.part[k] - quadrant * half_pi_1) - quadrant * half_pi_2) - quadrant * half_pi_3;
    const Native z = r * r;
    const Native s_poly = -1.66666666666666324348e-01 +
                          z * (8.33333333332248946124e-03 +
                               z * (-1.98412698298579493134e-04 +
                                    z * (2.75573137070700676789e-06 +
                                         z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10))));
    const Native c_poly = 4.16666666666666019037e-02 +
                          z * (-1.38888888888741095749e-03 +
                               z * (2.48015872894767294178e-05 +
                                    z * (-2.75573143513906633035e-07 +
                                         z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11))));
    const Native s = r + r * z * s_poly;
    const Native c = 1.0 - 0.5 * z + z * z * c_poly;
    const NativeMask swap = (bits & 1) != 0, negative_sin = (bits & 2) != 0, negative_cos = ((bits + 1) & 2) != 0;
    const Native sin_value = swap ? c : s, cos_value = swap ? s : c;
    out.sin.part[k] = negative_sin ? -sin_value : sin_value;
    out.cos.part[k] = negative_cos ? -cos_value : cos_value;
  }
  return out;
}

}  // namespace pliant::mpc::PLIANT_ISA
