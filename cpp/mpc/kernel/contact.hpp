// The contact seen from the joints: Jacobian, velocity and acceleration in the contact's axes, and their derivatives.
//
// Axes fixed in space (world, surface: those of the node's task): ẋ = R_cᵀ ṗ, ẍ = R_cᵀ p̈. Axes that turn with the frame
// (local): ẋ = Rᵀ ṗ and ẍ = d(Jv)/dt = Rᵀ (p̈ − ω × ṗ), the spatial acceleration. Rotational components (dimension 6):
// Rᵀω and its rate.
#pragma once
#include "dynamics.hpp"
#include "rotation_error.hpp"
#include "stage.hpp"

namespace pliant::mpc::PLIANT_ISA {

// Directions of a contact's components: axis c is `direction(c)`, along the force for c < 3, along the moment after.
struct ContactAxes {
  Mat R;  // columns in world axes
  bool turning;
  int dim;
  PLIANT_INLINE Vec direction(int c) const { return R.col(dim == 1 ? 2 : c % 3); }
  PLIANT_INLINE bool rotational(int c) const { return c >= 3; }
};

PLIANT_INLINE Lanes along(const ContactAxes& axes, int c, const Spatial& at_contact) {
  const Vec n = axes.direction(c);
  return axes.rotational(c) ? dot(at_contact.ang, n) : dot(at_contact.lin, n);
}
PLIANT_INLINE double along(const ContactAxes& axes, int c, const SpatialVec& at_contact) {
  const Vec n = axes.direction(c);
  return axes.rotational(c) ? dot(at_contact.ang, n) : dot(at_contact.lin, n);
}

struct Contact {
  ContactAxes axes;
  Vec point;                  // [m]
  Spatial jacobian;           // of the point, world axes; lane j: column j
  SpatialVec velocity;        // of the point
  Lanes J[max_contact];       // rows in contact axes
  double speed[max_contact];  // ẋ = J v
  double drift[max_contact];  // dJ/dt v
};

// Acceleration in contact axes of a point whose link accelerates by `a` (spatial, about the world's origin).
PLIANT_INLINE SpatialVec contact_acceleration(const Contact& c, const SpatialVec& a) {
  SpatialVec at = at_point(a, c.point);
  if (!c.axes.turning) at.lin = at.lin + cross(c.velocity.ang, c.velocity.lin);
  return at;
}

template <int J>
[[gnu::noinline]] void make_contact(const Chain& chain, const ModelData& model, const Mat& task, const Kinematics& kin,
                                    const Velocities& vel, const Dynamics& d, int dim, Contact& c) {
  const Frame frame = frame_on_last_link<J>(kin, chain.contact_rotation, chain.contact_translation);
  c.axes.turning = model.axes == Axes::local;
  c.axes.dim = dim;
  const Mat world = {{1, 0, 0, 0, 1, 0, 0, 0, 1}};
  c.axes.R = c.axes.turning ? frame.R : model.axes == Axes::surface ? task : world;
  c.point = frame.p;
  c.jacobian = at_point(kin.S, frame.p);
  c.velocity = at_point(vel.last, frame.p);
  const SpatialVec drift = contact_acceleration(c, lane(d.bias_acceleration, J - 1));
  for (int i = 0; i < dim; ++i) {
    c.J[i] = along(c.axes, i, c.jacobian);
    c.speed[i] = along(c.axes, i, c.velocity);
    c.drift[i] = along(c.axes, i, drift);
  }
}

// The wrench on the last link (about the world's origin) that forces λ in contact axes make.
PLIANT_INLINE SpatialVec contact_wrench(const Contact& c, const double* force, int dim) {
  Vec f = {0, 0, 0}, m = {0, 0, 0};
#pragma GCC unroll 6
  for (int i = 0; i < dim; ++i) {
    if (c.axes.rotational(i))
      m = m + c.axes.direction(i) * force[i];
    else
      f = f + c.axes.direction(i) * force[i];
  }
  return {f, cross(c.point, f) + m};
}

// Axes that do not turn with the last link: what ∂(Jᵀλ)/∂q is smaller by than for a wrench fixed to the link,
// row i lane j: J_iᵀ (ω_j × λ).
struct AxesCorrection {
  Vecs force, moment;  // ω_j × f, ω_j × m
};
PLIANT_INLINE AxesCorrection axes_correction(const Kinematics& kin, const Contact& c, const SpatialVec& wrench) {
  const Vec moment_at_point = wrench.ang - cross(c.point, wrench.lin);
  return {cross(kin.S.ang, wrench.lin), cross(kin.S.ang, moment_at_point)};
}
PLIANT_INLINE Lanes correction_row(const AxesCorrection& k, const Contact& c, int i) {
  return dot(k.force, lane(c.jacobian.lin, i)) + dot(k.moment, lane(c.jacobian.ang, i));
}

// Derivatives at constant joint acceleration, rows in contact axes.
struct ContactDerivatives {
  Lanes speed_q[max_contact];         // ∂ẋ/∂q; ∂ẋ/∂v is J
  Lanes acceleration_q[max_contact];  // ∂ẍ/∂q at constant v̇
  Lanes acceleration_v[max_contact];  // ∂ẍ/∂v
};

[[gnu::noinline]] inline void contact_derivatives(const Kinematics& kin, const Velocities& vel, const Dynamics& d,
                                                  const Contact& c, const Spatial& axis_acc,
                                                  const SpatialVec& last_acceleration, int dim,
                                                  ContactDerivatives& out) {
  // In axes that turn with the link: minus what the joint's own link does, v_j × S_j and its acceleration.
  Spatial speed_q = at_point(vel.axis_rate, c.point);
  Spatial rate = axis_acc - cross_motion(vel.last, vel.axis_rate);
  rate.lin = rate.lin - cross(d.up, kin.S.ang);
  Spatial acceleration_q = at_point(rate, c.point);
  Spatial acceleration_v = at_point(vel.axis_rate * 2.0 - cross_motion(vel.last, kin.S), c.point);
  if (!c.axes.turning) {  // add the turning of the vectors themselves, and the step from spatial to true acceleration
    const Vecs& w = kin.S.ang;
    const SpatialVec a = at_point(last_acceleration, c.point);
    speed_q = speed_q + Spatial{cross(w, c.velocity.lin), cross(w, c.velocity.ang)};
    acceleration_q = acceleration_q + Spatial{cross(w, a.lin), cross(w, a.ang)};
    acceleration_q.lin = acceleration_q.lin + cross(speed_q.ang, c.velocity.lin) + cross(c.velocity.ang, speed_q.lin);
    acceleration_v.lin =
        acceleration_v.lin + cross(c.jacobian.ang, c.velocity.lin) + cross(c.velocity.ang, c.jacobian.lin);
  }
  for (int i = 0; i < dim; ++i) {
    out.speed_q[i] = along(c.axes, i, speed_q);
    out.acceleration_q[i] = along(c.axes, i, acceleration_q);
    out.acceleration_v[i] = along(c.axes, i, acceleration_v);
  }
}

// Deflection e from the anchor in contact axes, [m] and (dimension 6) [rad], with ∂e/∂q.
template <int J>
[[gnu::noinline]] void deflection(const Chain& chain, const Kinematics& kin, const Contact& c, const Stage& stage,
                                  int dim, double* e, Lanes* e_q) {
  const Vec delta = c.point - stage.anchor;
  Vecs linear_q = c.jacobian.lin;
  if (c.axes.turning) linear_q = linear_q - cross(kin.S.ang, delta);
  const int linear = dim < 3 ? dim : 3;
  for (int i = 0; i < linear; ++i) {
    e[i] = dot(c.axes.direction(i), delta);
    e_q[i] = dot(linear_q, c.axes.direction(i));
  }
  if (dim < 6) return;
  const Frame frame = frame_on_last_link<J>(kin, chain.contact_rotation, chain.contact_translation);
  const RotationError error = rotation_error(stage.anchor_rotation, frame.R);
  // The log has the same components in R_ref's and R's axes, but its derivative has them in R_ref's only when those
  // are constant: local axes take the log itself, fixed axes take R_cᵀ R_ref log.
  const Mat identity = {{1, 0, 0, 0, 1, 0, 0, 0, 1}};
  const Mat to_axes = c.axes.turning ? identity : transposed(c.axes.R) * stage.anchor_rotation;
  const Vec rotation = to_axes * error.log;
  const Mat map = to_axes * error.jacobian * transposed(frame.R);
  const double values[3] = {rotation.x, rotation.y, rotation.z};
  for (int i = 0; i < 3; ++i) {
    e[3 + i] = values[i];
    e_q[3 + i] = dot(kin.S.ang, map.row(i));
  }
}

}  // namespace pliant::mpc::PLIANT_ISA
