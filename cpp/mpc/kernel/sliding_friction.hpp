// Coulomb friction of the predicted contact: the tangential force (components 0 and 1) is a bristle that gives way,
// after Dahl, "A solid friction model" (Aerospace Corporation TOR-0158(3107-18)-1, 1968), here with a damper and in the
// plane:
//     λ̇ = −K (y + c λ),  y = ẋ + (B/K) ẍ,  c = s(y)/(μ n(λ_z)),
// with a smooth speed s and a smooth normal force n. K y is what the visco-elastic contact makes of the motion; without
// friction c = 0. The step is implicit in λ, λ⁺ = (λ − dt K y)/(1 + dt K c): between λ and −μ n y/s, however stiff.
#pragma once
#include "node_values.hpp"
#include "stage.hpp"

namespace pliant::mpc::PLIANT_ISA {

constexpr double slow_sliding = 1e-3;  // [m/s] below it the bristle hardly gives way: keeps s smooth at rest
constexpr double light_touch = 1.0;    // [N] n at λ_z = 0: keeps the limit above zero in light and lost contact

struct SlidingRate {
  double rate[2];                  // λ̇ of the step, (λ⁺ − λ)/dt
  double by_sticking[2][2];        // ∂λ̇/∂ of the rate that a contact without friction has
  double by_own[2], by_normal[2];  // ∂λ̇_i/∂λ_i, ∂λ̇_i/∂λ_z
};

// From the rate without friction, −K y, and the force at the start of the step.
[[gnu::noinline]] inline void sliding_rate(const Stage& s, const double* sticking_rate, const double* force,
                                           SlidingRate& out) {
  const double y[2] = {-sticking_rate[0] / s.stiffness[0], -sticking_rate[1] / s.stiffness[1]};
  const double square = y[0] * y[0] + y[1] * y[1], rounded = square + slow_sliding * slow_sliding;
  const double speed = square / sqrt(rounded);
  const double slope = (rounded + slow_sliding * slow_sliding) / (rounded * sqrt(rounded));  // ∂s/∂y = slope y

  // n = (λ_z + √(λ_z² + 4 light²))/2, written without cancellation; ∂n/∂λ_z = n/root.
  const double normal = force[2], root = sqrt(normal * normal + 4 * light_touch * light_touch);
  const double pressing = normal > 0 ? 0.5 * (normal + root) : 2 * light_touch * light_touch / (root - normal);
  const double limit = s.sliding_friction * pressing, yielding = speed / limit;
  for (int i = 0; i < 2; ++i) {
    const double K = s.stiffness[i], implicit = 1 / (1 + s.dt * K * yielding);
    out.rate[i] = (sticking_rate[i] - K * yielding * force[i]) * implicit;
    out.by_own[i] = -K * yielding * implicit;
    const double by_yielding = -K * implicit * (force[i] + s.dt * out.rate[i]);
    out.by_normal[i] = -by_yielding * yielding / root;
    for (int j = 0; j < 2; ++j)
      out.by_sticking[i][j] = (i == j ? implicit : 0) - by_yielding * slope * y[j] / (limit * s.stiffness[j]);
  }
}

// The tangent of the force rates without friction becomes that with friction.
template <class L>
PLIANT_INLINE void apply_sliding_tangent(const SlidingRate& slide, NodeValues<L>& n) {
  Row<L>* rate_x = n.rate_x + L::J;
  Lanes* rate_u = n.rate_u + L::J;
  const Row<L> sticking_x[2] = {rate_x[0], rate_x[1]};
  const Lanes sticking_u[2] = {rate_u[0], rate_u[1]};
#pragma GCC unroll 2
  for (int i = 0; i < 2; ++i) {
    rate_x[i] = sticking_x[0];
    scale(rate_x[i], slide.by_sticking[i][0]);
    add_scaled(rate_x[i], sticking_x[1], slide.by_sticking[i][1]);
    rate_x[i].add(L::force_lane(i), slide.by_own[i]);
    rate_x[i].add(L::force_lane(2), slide.by_normal[i]);
    rate_u[i] = sticking_u[0] * slide.by_sticking[i][0] + sticking_u[1] * slide.by_sticking[i][1];
  }
}

}  // namespace pliant::mpc::PLIANT_ISA
