// Rigid-body dynamics of the chain: mass matrix and inverse, inverse dynamics, and its analytic derivatives after
// Singh, Russell and Wensing, "Efficient analytical derivatives of rigid-body dynamics using spatial vector algebra"
// (2022), with every sum over the subtree done as a running sum over lanes.
#pragma once
#include "kinematics.hpp"

namespace pliant::mpc::PLIANT_ISA {

// Inertia of every link about the world's origin.
PLIANT_INLINE void world_inertia(const Chain& chain, const Kinematics& kin, Inertia& Y) {
  const Vecs &x = kin.x_axis, &y = kin.y_axis, &z = kin.z_axis;
  const Vecs com = x * chain.com_x + y * chain.com_y + z * chain.com_z + kin.origin;
  const Sym& I = chain.inertia;
  const Vecs Ix = x * I.xx + y * I.xy + z * I.xz;  // columns of R I
  const Vecs Iy = x * I.xy + y * I.yy + z * I.yz;
  const Vecs Iz = x * I.xz + y * I.yz + z * I.zz;
  Y.mass = chain.mass;
  Y.moment = com * chain.mass;
  const Lanes mxx = Y.moment.x * com.x, myy = Y.moment.y * com.y, mzz = Y.moment.z * com.z;
  Y.rotational.xx = Ix.x * x.x + Iy.x * y.x + Iz.x * z.x + myy + mzz;  // R I Rᵀ + m (cᵀc 1 − c cᵀ)
  Y.rotational.xy = Ix.x * x.y + Iy.x * y.y + Iz.x * z.y - Y.moment.x * com.y;
  Y.rotational.xz = Ix.x * x.z + Iy.x * y.z + Iz.x * z.z - Y.moment.x * com.z;
  Y.rotational.yy = Ix.y * x.y + Iy.y * y.y + Iz.y * z.y + mxx + mzz;
  Y.rotational.yz = Ix.y * x.z + Iy.y * y.z + Iz.y * z.z - Y.moment.y * com.z;
  Y.rotational.zz = Ix.z * x.z + Iy.z * y.z + Iz.z * z.z + mxx + myy;
}

struct Dynamics {
  Inertia link, subtree;         // Y_j and Σ over the links from j on
  Spatial momentum;              // Y_j v_j
  Spatial gyroscopic;            // v_j ×* Y_j v_j
  Spatial subtree_inertia_axis;  // (Σ Y) S_j: the columns of M before projection
  Spatial bias_acceleration;     // Σ (dS/dt) q̇, without gravity
  Vec up;                        // −gravity, the acceleration that stands for weight
};

PLIANT_INLINE void dynamics(const Chain& chain, const Kinematics& kin, const Velocities& vel, const Lanes& qd,
                            Dynamics& d) {
  world_inertia(chain, kin, d.link);
  sum_outward(d.link, d.subtree);
  d.momentum = d.link * vel.link;
  d.gyroscopic = cross_force(vel.link, d.momentum);
  d.subtree_inertia_axis = d.subtree * kin.S;
  sum_inward(vel.axis_rate * qd, d.bias_acceleration);
  d.up = -chain.gravity;
}

// Force each joint transmits for link accelerations `a` (gravity included) and a wrench on the last link.
PLIANT_INLINE Spatial transmitted(const Dynamics& d, const Spatial& a, const SpatialVec& wrench) {
  return sum_outward(d.link * a + d.gyroscopic) - splat(wrench);
}

PLIANT_INLINE Spatial with_gravity(const Spatial& a, const Dynamics& d) { return {a.lin + splat(d.up), a.ang}; }

// Lower triangle of M by rows of lanes: row[i] is right in the lanes j ≥ i.
template <int J>
struct MassMatrix {
  Lanes row[J];
};

template <int J>
PLIANT_INLINE void mass_matrix(const Chain& chain, const Kinematics& kin, const Dynamics& d, MassMatrix<J>& M) {
#pragma GCC unroll 1
  for (int i = 0; i < J; ++i) M.row[i] = dot(d.subtree_inertia_axis, lane(kin.S, i)) + only(i, chain.armature);
}

// Inverse of a symmetric positive definite matrix whose rows are right in the lanes j ≥ i.
template <int J>
struct Inverse {
  Lanes row[J];
};

// L D Lᵀ, in scalars: no square root on the path from column to column, and one division each.
template <int J>
struct Factor {
  double lower[J][J];    // L below its diagonal of ones
  double reciprocal[J];  // D⁻¹
};

template <int J>
PLIANT_INLINE void factorise(const Lanes* rows, Factor<J>& f) {
  double scaled[J][J];  // L D
#pragma GCC unroll 8
  for (int j = 0; j < J; ++j) {
    double pivot = rows[j][j];
#pragma GCC unroll 8
    for (int k = 0; k < j; ++k) pivot -= scaled[j][k] * f.lower[j][k];
    f.reciprocal[j] = 1 / pivot;
#pragma GCC unroll 8
    for (int i = j + 1; i < J; ++i) {
      scaled[i][j] = rows[j][i];
#pragma GCC unroll 8
      for (int k = 0; k < j; ++k) scaled[i][j] -= scaled[i][k] * f.lower[j][k];
      f.lower[i][j] = scaled[i][j] * f.reciprocal[j];
    }
  }
}

template <int J>
PLIANT_INLINE void invert(const MassMatrix<J>& M, Inverse<J>& inverse) {
  Factor<J> factor;
  factorise<J>(M.row, factor);
  Lanes half[J], scaled[J];  // rows of L⁻¹ and D^(−1/2) L⁻¹: the inverse comes out symmetric to the last bit
#pragma GCC unroll 8
  for (int i = 0; i < J; ++i) {
    half[i] = only(i, splat(1));
#pragma GCC unroll 8
    for (int k = 0; k < i; ++k) half[i] -= half[k] * factor.lower[i][k];
    scaled[i] = half[i] * sqrt(factor.reciprocal[i]);
  }
#pragma GCC unroll 8
  for (int i = 0; i < J; ++i) {
    Lanes r = zero();
#pragma GCC unroll 8
    for (int k = i; k < J; ++k) r += scaled[k] * scaled[k][i];
    inverse.row[i] = r;
  }
}

template <int J>
PLIANT_INLINE Lanes multiply(const Lanes* rows, const Lanes& v) {  // symmetric matrix times vector
  Lanes r = zero();
#pragma GCC unroll 8
  for (int i = 0; i < J; ++i) r += rows[i] * v[i];
  return r;
}

// Σ over the subtree of the matrix that turns a motion m into the force change it makes through the velocities.
// Only the angular part of m matters: linear momentum gives force, D and the angular momentum give moment.
struct VelocityCoupling {
  Spatial momentum;  // of the subtree
  Sym D;
};

PLIANT_INLINE VelocityCoupling velocity_coupling(const Dynamics& d, const Velocities& vel) {
  const Vecs &c = d.link.moment, &v = vel.link.lin, &w = vel.link.ang;
  const Sym& I = d.link.rotational;
  const Lanes vc = dot(v, c);
  Sym D;
  D.xx = 2.0 * (vc - c.x * v.x + w.y * I.xz - w.z * I.xy);
  D.yy = 2.0 * (vc - c.y * v.y + w.z * I.xy - w.x * I.yz);
  D.zz = 2.0 * (vc - c.z * v.z + w.x * I.yz - w.y * I.xz);
  D.xy = w.y * I.yz - w.z * I.yy + w.z * I.xx - w.x * I.xz - c.x * v.y - c.y * v.x;
  D.xz = w.y * I.zz - w.z * I.yz + w.x * I.xy - w.y * I.xx - c.x * v.z - c.z * v.x;
  D.yz = w.z * I.xz - w.x * I.zz + w.x * I.yy - w.y * I.xy - c.y * v.z - c.z * v.y;
  VelocityCoupling B;
  sum_outward(d.momentum, B.momentum);
  sum_outward(D, B.D);
  return B;
}
PLIANT_INLINE Spatial operator*(const VelocityCoupling& B, const Spatial& m) {
  return {cross(B.momentum.lin, m.ang) * -2.0, B.D * m.ang - cross(B.momentum.ang, m.ang)};
}
// S_iᵀ times the coupling, as a vector against the angular part of a motion.
PLIANT_INLINE Vecs transposed_times(const VelocityCoupling& B, const Spatial& S) {
  return cross(B.momentum.lin, S.lin) * 2.0 + B.D * S.ang + cross(B.momentum.ang, S.ang);
}

// Rates of the joint axes under acceleration: what an acceleration changes by when a joint before it turns.
PLIANT_INLINE Spatial axis_acceleration(const Kinematics& kin, const Velocities& vel, const Dynamics& d,
                                        const Spatial& a_with_gravity) {
  Spatial before = parent(a_with_gravity);
  before.lin.x.set(0, d.up.x);
  before.lin.y.set(0, d.up.y);
  before.lin.z.set(0, d.up.z);
  return cross_motion(before, kin.S) + cross_motion(vel.parent, vel.axis_rate);
}

// ∂/∂q and ∂/∂v of the inverse dynamics M a + h − Jᵀλ at constant a and λ fixed *to the last link*; row i, lane j.
template <int J>
struct DynamicsDerivatives {
  Lanes q[J], v[J];
};

template <int J>
PLIANT_INLINE void inverse_dynamics_derivatives(const Chain& chain, const Kinematics& kin, const Velocities& vel,
                                                const Dynamics& d, const Spatial& axis_acc, const Spatial& force,
                                                DynamicsDerivatives<J>& out) {
  const VelocityCoupling B = velocity_coupling(d, vel);
  const Spatial axis_rate2 = vel.axis_rate * 2.0;
  // Joint j after joint i: the force that joint j's change makes on its subtree, felt at i.
  const Spatial outer_q = d.subtree * axis_acc + B * vel.axis_rate + cross_force(kin.S, force);
  const Spatial outer_v = B * kin.S + d.subtree * axis_rate2;
  // Joint j before joint i: the motion that joint j's change makes at i, against i's subtree.
  const Vecs inner = transposed_times(B, kin.S);
#pragma GCC unroll 1
  for (int i = 0; i < J; ++i) {
    const SpatialVec S = lane(kin.S, i), F = lane(d.subtree_inertia_axis, i);
    const Vec b = lane(inner, i);
    out.q[i] = select_from(i, dot(outer_q, S), dot(axis_acc, F) + dot(vel.axis_rate.ang, b));
    out.v[i] = select_from(i, dot(outer_v, S), dot(axis_rate2, F) + dot(kin.S.ang, b)) + only(i, chain.joint_damping);
  }
}

// Torque that holds the robot at rest under a wrench on the last link: g(q) − Jᵀλ.
PLIANT_INLINE Lanes gravity_torque(const Kinematics& kin, const Dynamics& d, const SpatialVec& wrench) {
  const Spatial weight = {splat(d.up) * d.subtree.mass - splat(wrench.lin),
                          cross(d.subtree.moment, d.up) - splat(wrench.ang)};
  return dot(kin.S, weight);
}

// ∂/∂q of the above, the wrench fixed to the last link; row i, lane j.
template <int J>
PLIANT_INLINE void gravity_torque_derivative(const Kinematics& kin, const Dynamics& d, const SpatialVec& wrench,
                                             Lanes* rows) {
  const Vecs moment_rate = kin.S.lin * d.subtree.mass + cross(kin.S.ang, d.subtree.moment);  // of the subtree
  const Spatial outer = {cross(wrench.lin, kin.S.ang),
                         cross(moment_rate, d.up) - cross(kin.S.lin, splat(wrench.lin)) + cross(wrench.ang, kin.S.ang)};
  const Vecs inner = cross(d.up, kin.S.ang);
#pragma GCC unroll 1
  for (int i = 0; i < J; ++i) rows[i] = select_from(i, dot(outer, lane(kin.S, i)), dot(inner, lane(moment_rate, i)));
}

}  // namespace pliant::mpc::PLIANT_ISA
