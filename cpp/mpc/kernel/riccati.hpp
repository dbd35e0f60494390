// One backward and one forward step of the Riccati recursion on the structured tangent (see node_values.hpp).
#pragma once
#include "tangent.hpp"

namespace pliant::mpc::PLIANT_ISA {

// Value function ½ xᵀPx + pᵀx of a stage and the factored control law δu = −R⁻ᵀ(Y δx + y), RRᵀ = Q_uu.
template <class L>
struct alignas(64) StageFactor {
  Row<L> P[L::size], p;
  Row<L> Y[L::J];
  double y[lane_count];
  double lower[L::J][lane_count], reciprocal[lane_count];
};

// Cholesky factor of Q_uu (rows of lanes, symmetric); false when it is not positive definite.
template <class L>
PLIANT_INLINE bool factor_control(const Lanes* Quu, StageFactor<L>& f) {
  constexpr int J = L::J;
#pragma GCC unroll 8
  for (int j = 0; j < J; ++j) {
    double s = Quu[j][j];
#pragma GCC unroll 8
    for (int k = 0; k < j; ++k) s -= f.lower[j][k] * f.lower[j][k];
    if (!(s > 0)) return false;
    const double d = sqrt(s);
    f.lower[j][j] = d;
    f.reciprocal[j] = 1 / d;
#pragma GCC unroll 8
    for (int i = j + 1; i < J; ++i) {
      double t = Quu[j][i];
#pragma GCC unroll 8
      for (int k = 0; k < j; ++k) t -= f.lower[i][k] * f.lower[j][k];
      f.lower[i][j] = t * f.reciprocal[j];
    }
  }
  return true;
}

template <class L>
PLIANT_INLINE void control_law(const Row<L>* Qux, const Lanes& Qu, StageFactor<L>& f) {
#pragma GCC unroll 8
  for (int i = 0; i < L::J; ++i) {
    Row<L> row = Qux[i];
    double s = Qu[i];
#pragma GCC unroll 8
    for (int k = 0; k < i; ++k) {
      add_scaled(row, f.Y[k], -f.lower[i][k]);
      s -= f.lower[i][k] * f.y[k];
    }
    scale(row, f.reciprocal[i]);
    f.Y[i] = row;
    f.y[i] = s * f.reciprocal[i];
  }
}

// Gᵀ P, Gᵀ P E and Gᵀ P G.
template <class L>
struct Projected {
  Row<L> GP[L::rates], GPE[L::rates];
  double GPG[L::rates][L::rates];
};

template <class L>
PLIANT_INLINE void project(const Row<L>* P, const Step<L>& s, Projected<L>& g) {
  constexpr int J = L::J;
#pragma GCC unroll 1
  for (int i = 0; i < J; ++i) {
    g.GP[i] = zero_row<L>();
    add_scaled(g.GP[i], P[i], s.dt * s.dt);
    add_scaled(g.GP[i], P[L::velocity + i], s.dt);
  }
#pragma GCC unroll 6
  for (int f = 0; f < L::M; ++f) {
    g.GP[J + f] = zero_row<L>();
    add_scaled(g.GP[J + f], P[L::force_lane(f)], s.dt);
  }
#pragma GCC unroll 1
  for (int i = 0; i < L::rates; ++i) {
    g.GPE[i] = times_E(g.GP[i], s);
    times_G(g.GP[i], s, g.GPG[i]);
  }
}

template <class L>
[[gnu::noinline]] bool backward_step(const Tangent<L>& t, const Expansion<L>& e, const Row<L>& gap,
                                     const StageFactor<L>& next, const Step<L>& s, double regularisation,
                                     StageFactor<L>& now) {
  constexpr int J = L::J;
  const Row<L>* P = next.P;
  Row<L> p = next.p;  // gradient of the next value at the gap
#pragma GCC unroll 1
  for (int i = 0; i < L::size; ++i) add_scaled(p, P[i], gap[i]);
  Projected<L> g;
  project(P, s, g);

  Row<L> Z[L::rates];  // GᵀP ∂x⁺/∂x
#pragma GCC unroll 1
  for (int i = 0; i < L::rates; ++i) {
    Z[i] = g.GPE[i];
#pragma GCC unroll 14
    for (int j = 0; j < L::rates; ++j) add_scaled(Z[i], t.rate_x[j], g.GPG[i][j]);
  }
  Row<L> Qx, Qux[J];
  Lanes Qu, Quu[J];
  times_tangent(p, t, s, Qx, Qu);
  for (int b = 0; b < L::blocks; ++b) Qx.block[b] += e.Lx.block[b];
  Qu += e.Lu;
  if constexpr (L::has_torque) {
    const double pass = 1 - s.alpha;
#pragma GCC unroll 1
    for (int i = 0; i < J; ++i) {
      Quu[i] = e.Luu[i] + P[L::rest + i].block[2] * (pass * pass);
      Qux[i] = e.Lux[i];
      add_scaled(Qux[i], times_E(P[L::rest + i], s), pass);
#pragma GCC unroll 8
      for (int j = 0; j < J; ++j) add_scaled(Qux[i], t.rate_x[j], pass * g.GP[j][L::rest + i]);
    }
  } else {
    Lanes HU[L::rates];  // GᵀPG ∂z/∂u
#pragma GCC unroll 1
    for (int i = 0; i < L::rates; ++i) {
      HU[i] = zero();
#pragma GCC unroll 14
      for (int j = 0; j < L::rates; ++j) HU[i] += t.rate_u[j] * g.GPG[i][j];
    }
#pragma GCC unroll 1
    for (int i = 0; i < J; ++i) {
      Quu[i] = e.Luu[i];
      Qux[i] = e.Lux[i];
#pragma GCC unroll 14
      for (int j = 0; j < L::rates; ++j) {
        Quu[i] += HU[j] * t.rate_u[j][i];
        add_scaled(Qux[i], Z[j], t.rate_u[j][i]);
      }
    }
  }
#pragma GCC unroll 8
  for (int i = 0; i < J; ++i) Quu[i].add(i, regularisation);
  if (!factor_control(Quu, now)) return false;
  control_law(Qux, Qu, now);

#pragma GCC unroll 1
  for (int r = 0; r < L::size; ++r) {  // P = L_xx + EᵀPE + rate_xᵀ GᵀPE + Zᵀ rate_x − YᵀY
    if (idle<L>(r)) {
      now.P[r] = zero_row<L>();
      continue;
    }
    Row<L> left = P[r];
    if (r >= L::velocity && r < L::velocity + J) add_scaled(left, P[r - L::velocity], s.dt);
    if constexpr (L::has_torque)
      if (r >= L::rest) scale(left, s.alpha);
    Row<L> row = times_E(left, s);
#pragma GCC unroll 4
    for (int b = 0; b < L::blocks; ++b) row.block[b] += e.Lxx[r].block[b];
#pragma GCC unroll 14
    for (int j = 0; j < L::rates; ++j) {
      add_scaled(row, t.rate_x[j], g.GPE[j][r]);
      add_scaled(row, Z[j], t.rate_x[j][r]);
    }
#pragma GCC unroll 8
    for (int j = 0; j < J; ++j) add_scaled(row, now.Y[j], -now.Y[j][r]);
    row.add(r, regularisation);
    now.P[r] = row;
  }
#pragma GCC unroll 8
  for (int j = 0; j < J; ++j) add_scaled(Qx, now.Y[j], -now.y[j]);
  now.p = Qx;
  return true;
}

template <class L>
PLIANT_INLINE void terminal_step(const Expansion<L>& e, double regularisation, StageFactor<L>& now) {
  for (int r = 0; r < L::size; ++r) {
    now.P[r] = e.Lxx[r];
    now.P[r].add(r, regularisation);
  }
  now.p = e.Lx;
}

// δu of the law at δx, by back substitution.
template <class L>
PLIANT_INLINE Lanes control_step(const StageFactor<L>& f, const Row<L>& dx) {
  alignas(64) double d[lane_count] = {};
#pragma GCC unroll 8
  for (int i = L::J - 1; i >= 0; --i) {
    double s = f.y[i] + dot(f.Y[i], dx);
#pragma GCC unroll 8
    for (int k = i + 1; k < L::J; ++k) s -= f.lower[k][i] * d[k];
    d[i] = s * f.reciprocal[i];
  }
  return -load(d);
}

// Multiplier of the dynamics: gradient of the value function at δx.
template <class L>
PLIANT_INLINE Row<L> costate(const StageFactor<L>& f, const Row<L>& dx) {
  Row<L> r = f.p;
#pragma GCC unroll 1
  for (int i = 0; i < L::size; ++i) add_scaled(r, f.P[i], dx[i]);
  return r;
}

}  // namespace pliant::mpc::PLIANT_ISA
