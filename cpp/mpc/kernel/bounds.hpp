// Inequality bounds of a stage as terms of an augmented Lagrangian.
//
// The quadratic programme of an SQP step, min ½δᵀHδ + gᵀδ subject to z + Dδ ∈ C (boxes on torque and force, friction
// cone), is solved by the method of multipliers: the terms ρ/2 dist²(z + Dδ + y/ρ, C) join the cost, a semismooth
// Newton method minimises (each step is one Riccati recursion with the active rows stiffened by ρ), and y becomes the
// gradient of the terms. After Hermans, Themelis and Patrinos, "QPALM: a proximal augmented Lagrangian method for
// nonconvex quadratic programs" (2022), on the recursion instead of a sparse factorisation. ρ is large beside the
// curvature of the cost, so that y settles in one or two updates, fewer with y kept from the last solve.
#pragma once
#include "node_values.hpp"
#include "stage.hpp"

namespace pliant::mpc::PLIANT_ISA {

constexpr double penalty = 1e2;  // ρ [cost/N²]

struct alignas(64) StageBounds {
  Lanes torque_lower, torque_upper;
  double force_lower[max_contact], force_upper[max_contact];
  double friction;
  int forces;         // bounded force components: all of the contact's, or 0
  bool torque, cone;  // whether there is anything to do
};

inline void make_stage_bounds(const NodeData& data, const ModelData& model, int dof, bool first, bool terminal,
                              StageBounds& b) {
  b.torque_lower = splat(-HUGE_VAL);
  b.torque_upper = splat(HUGE_VAL);
  b.torque = false;
  for (int i = 0; i < dof && !terminal; ++i) {
    b.torque_lower.set(i, data.torque_lower[i]);
    b.torque_upper.set(i, data.torque_upper[i]);
    b.torque = b.torque || isfinite(data.torque_lower[i]) || isfinite(data.torque_upper[i]);
  }
  // Where the force follows from the state alone, the first one is measured, not chosen; the last node has a force
  // only where it is part of the state.
  const bool chosen = !first || model.kind == Kind::classical;
  const bool known = !terminal || model.kind == Kind::force_feedback;
  const bool here = data.contact_active && model.contact_dim > 0 && chosen && known;
  b.forces = 0;
  for (int c = 0; c < model.contact_dim; ++c) {
    b.force_lower[c] = data.force_lower[c];
    b.force_upper[c] = data.force_upper[c];
    if (here && (isfinite(b.force_lower[c]) || isfinite(b.force_upper[c]))) b.forces = model.contact_dim;
  }
  b.friction = data.friction;
  b.cone = here && model.contact_dim >= 3 && isfinite(data.friction);
}

// Multipliers of one stage, or anything else with one number per bound.
struct alignas(64) BoundVector {
  Lanes torque;
  double force[max_contact], cone[3];
};

PLIANT_INLINE double clip(double v, double lower, double upper) { return v < lower ? lower : v > upper ? upper : v; }

// Friction cone ‖(x, y)‖ ≤ μ z: v minus its projection, and the derivative of that (symmetric).
PLIANT_INLINE Vec outside_cone(const Vec& v, double mu, Mat& G) {
  const double tangential = sqrt(v.x * v.x + v.y * v.y);
  if (tangential <= mu * v.z) {
    G = {};
    return {0, 0, 0};
  }
  if (mu * tangential <= -v.z) {
    G = {{1, 0, 0, 0, 1, 0, 0, 0, 1}};
    return v;
  }
  const double share = 1 / (1 + mu * mu), nx = v.x / tangential, ny = v.y / tangential;
  const double normal = (mu * tangential + v.z) * share, radial = mu * mu * share, side = mu * normal / tangential;
  const double d = radial - side, c = -mu * share;
  G = {{1 - side - d * nx * nx, -d * nx * ny, c * nx, -d * nx * ny, 1 - side - d * ny * ny, c * ny, c * nx, c * ny,
        1 - share}};
  return {v.x - mu * normal * nx, v.y - mu * normal * ny, v.z - normal};
}

// The terms at one point: gradient (the next multipliers) and generalised second derivative, both in the bound's
// values.
struct alignas(64) BoundTerms {
  BoundVector gradient;
  Lanes torque_active;
  double force_active[max_contact];
  Mat cone_active;
  Lanes torque_at;  // the point
  double force_at[max_contact];
};

PLIANT_INLINE void bound_terms(const StageBounds& b, const BoundVector& y, const Lanes& torque, const double* force,
                               BoundTerms& t) {
  t.torque_at = torque;
  t.gradient = BoundVector{};  // a bound that is not there has no multiplier, whatever it had when it was
  t.torque_active = zero();
  if (b.torque) {
    const Lanes v = torque + y.torque * (1 / penalty);
    const Lanes below = v - b.torque_lower, above = v - b.torque_upper;  // ±inf where there is no bound
    PLIANT_EACH_PART {
      const Native none = {};
      const Native outside = below.part[k] < none ? below.part[k] : above.part[k] > none ? above.part[k] : none;
      t.gradient.torque.part[k] = outside * penalty;
      t.torque_active.part[k] = outside != none ? none + 1.0 : none;
    }
  }
  for (int c = 0; c < b.forces; ++c) {
    const double v = force[c] + y.force[c] / penalty, outside = v - clip(v, b.force_lower[c], b.force_upper[c]);
    t.force_at[c] = force[c];
    t.gradient.force[c] = outside * penalty;
    t.force_active[c] = outside != 0 ? 1 : 0;
  }
  if (!b.cone) return;
  for (int c = 0; c < 3; ++c) t.force_at[c] = force[c];
  const Vec outside = outside_cone(vec(force) + vec(y.cone) * (1 / penalty), b.friction, t.cone_active);
  t.gradient.cone[0] = outside.x * penalty;
  t.gradient.cone[1] = outside.y * penalty;
  t.gradient.cone[2] = outside.z * penalty;
}

// Gradient that the local model at `t` predicts for another point.
PLIANT_INLINE void predicted_gradient(const StageBounds& b, const BoundTerms& t, const Lanes& torque,
                                      const double* force, BoundVector& out) {
  out.torque = t.gradient.torque + t.torque_active * (torque - t.torque_at) * penalty;
  for (int c = 0; c < b.forces; ++c)
    out.force[c] = t.gradient.force[c] + t.force_active[c] * penalty * (force[c] - t.force_at[c]);
  if (!b.cone) return;
  const Vec move = vec(force) - vec(t.force_at);
  for (int c = 0; c < 3; ++c) out.cone[c] = t.gradient.cone[c] + penalty * dot(t.cone_active.row(c), move);
}

PLIANT_INLINE double largest_difference(const StageBounds& b, const BoundVector& a, const BoundVector& c) {
  double worst = b.torque ? largest(absolute(a.torque - c.torque)) : 0;
  for (int i = 0; i < b.forces; ++i) worst = larger(worst, magnitude(a.force[i] - c.force[i]));
  for (int i = 0; i < 3 && b.cone; ++i) worst = larger(worst, magnitude(a.cone[i] - c.cone[i]));
  return worst;
}

// How far the multipliers are from what a local model predicted for them, beside their size. They are compared as
// multipliers, not as ‖·‖/ρ in the bounds' units: small as the costs are, a row held by 1e-5 would pass for a free one.
struct DualError {
  double torque = 0, force = 0, torque_size = 0, force_size = 0;

  void add(const StageBounds& b, const BoundVector& predicted, const BoundVector& actual) {
    if (b.torque) {
      torque = larger(torque, largest(absolute(predicted.torque - actual.torque)));
      torque_size = larger(torque_size, largest(absolute(actual.torque)));
    }
    for (int i = 0; i < b.forces; ++i) add_force(predicted.force[i], actual.force[i]);
    for (int i = 0; i < 3 && b.cone; ++i) add_force(predicted.cone[i], actual.cone[i]);
  }
  void add_force(double predicted, double actual) {
    force = larger(force, magnitude(predicted - actual));
    force_size = larger(force_size, magnitude(actual));
  }
  bool small() const {
    constexpr double share = 1e-3;
    return torque <= share * torque_size && force <= share * force_size;
  }
};

// Distance to the feasible set: Σ |·| for the filter, ∞-norm for the report.
struct Violation {
  double sum, worst;
};
PLIANT_INLINE Violation bound_violation(const StageBounds& b, const Lanes& torque, const double* force) {
  Violation v = {0, 0};
  if (b.torque) {
    const Lanes none = zero();
    const Lanes outside = larger(larger(b.torque_lower - torque, torque - b.torque_upper), none);
    v = {sum(outside), largest(outside)};
  }
  const auto add = [&v](double outside) {
    v.sum += outside;
    v.worst = larger(v.worst, outside);
  };
  for (int c = 0; c < b.forces; ++c) add(magnitude(force[c] - clip(force[c], b.force_lower[c], b.force_upper[c])));
  if (b.cone) add(larger(sqrt(force[0] * force[0] + force[1] * force[1]) - b.friction * force[2], 0.0));
  return v;
}

// ∂λ_c/∂x and ∂λ_c/∂u at a node.
template <class L>
PLIANT_INLINE void force_row(const NodeValues<L>& n, int c, Row<L>& row_x, Lanes& row_u) {
  if constexpr (L::extra == Extra::force) {
    row_x = zero_row<L>();
    row_x.set(L::force_lane(c), 1);
    row_u = zero();
  } else {
    row_x = n.force_x[c];
    row_u = n.force_u[c];
  }
}

// Adds Dᵀy to the gradient of the cost.
template <class L>
PLIANT_INLINE void add_multipliers(const StageBounds& b, const BoundVector& y, const NodeValues<L>& n, Row<L>& Lx,
                                   Lanes& Lu) {
  if (b.torque) Lu += y.torque;
  const int rows = b.cone ? larger(b.forces, 3) : b.forces;
  for (int c = 0; c < rows; ++c) {
    Row<L> row_x;
    Lanes row_u;
    force_row(n, c, row_x, row_u);
    const double value = (c < b.forces ? y.force[c] : 0) + (b.cone && c < 3 ? y.cone[c] : 0);
    add_scaled(Lx, row_x, value);
    Lu += row_u * value;
  }
}

// Adds ρ Dᵀ A D to the second derivatives, A the active part of the terms.
template <class L>
PLIANT_INLINE void stiffen(const StageBounds& b, const BoundTerms& t, const NodeValues<L>& n, Expansion<L>& e) {
  if (b.torque)
    for (int i = 0; i < L::J; ++i) e.Luu[i].add(i, penalty * t.torque_active[i]);
  const int rows = b.cone ? larger(b.forces, 3) : b.forces;
  for (int c = 0; c < rows; ++c)
    for (int d = 0; d < rows; ++d) {
      double a = c == d && c < b.forces ? t.force_active[c] : 0;
      if (b.cone && c < 3 && d < 3) a += t.cone_active.m[3 * c + d];
      if (a == 0) continue;
      Row<L> cx, dx;
      Lanes cu, du;
      force_row(n, c, cx, cu);
      force_row(n, d, dx, du);
      for (int k = 0; k < L::size; ++k) add_scaled(e.Lxx[k], dx, penalty * a * cx[k]);
      for (int i = 0; i < L::J; ++i) {
        add_scaled(e.Lux[i], dx, penalty * a * cu[i]);
        e.Luu[i] += du * (penalty * a * cu[i]);
      }
    }
}

// The cost of a stage with the terms, as a quadratic about the iterate (δ = 0) from their model at another δ.
template <class L>
PLIANT_INLINE void bounded_expansion(const StageBounds& b, const BoundTerms& t, const NodeValues<L>& n,
                                     const Lanes& torque, Expansion<L>& e) {
  e = static_cast<const Expansion<L>&>(n);
  BoundVector at_zero;
  predicted_gradient(b, t, torque, n.force, at_zero);
  add_multipliers(b, at_zero, n, e.Lx, e.Lu);
  stiffen(b, t, n, e);
}

}  // namespace pliant::mpc::PLIANT_ISA
