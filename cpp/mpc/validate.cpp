#include "validate.hpp"

#include <cmath>
#include <sstream>
#include <stdexcept>

namespace pliant::mpc {
namespace {

template <class... Parts>
[[noreturn]] void reject(const Parts&... parts) {
  std::ostringstream message;
  (message << ... << parts);
  throw std::invalid_argument(message.str());
}

bool is_rotation(const double* R) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      double d = 0;
      for (int k = 0; k < 3; ++k) d += R[3 * i + k] * R[3 * j + k];
      if (!(std::abs(d - (i == j)) < 1e-6)) return false;
    }
  return R[0] * (R[4] * R[8] - R[5] * R[7]) - R[1] * (R[3] * R[8] - R[5] * R[6]) + R[2] * (R[3] * R[7] - R[4] * R[6]) >
         0;
}

bool all_finite(const double* v, int count) {
  for (int i = 0; i < count; ++i)
    if (!std::isfinite(v[i])) return false;
  return true;
}

// Value checks of one node, with its index for the message.
struct NodeCheck {
  int index;

  void weights(const char* name, const double* v, int count) const {
    for (int i = 0; i < count; ++i)
      if (!(v[i] >= 0) || !std::isfinite(v[i]))
        reject(name, " must be finite and not negative, but node ", index, " has ", v[i], " at component ", i);
  }
  void references(const char* name, const double* v, int count) const {
    if (!all_finite(v, count)) reject(name, " must be finite, but node ", index, " has a value that is not");
  }
  void rotation(const char* name, const double* R) const {
    if (!is_rotation(R)) reject(name, " must be a rotation matrix, but node ", index, " has another");
  }
  void positive(const char* name, const double* v, int count) const {
    for (int i = 0; i < count; ++i)
      if (!(v[i] > 0) || !std::isfinite(v[i]))
        reject(name, " of a contact must be positive, but node ", index, " has ", v[i], " at component ", i);
  }
  // Explicit Euler of ẍ = W λ, λ̇ = −K ẋ − B ẍ has determinant 1 − dt B W + dt² K W: below 1 only for K dt < B.
  void explicit_step(const NodeData& d, int count, double dt) const {
    for (int i = 0; i < count; ++i)
      if (!(d.stiffness[i] * dt < d.damping[i]))
        reject("with the Euler integrator stiffness · dt must stay below damping, but node ", index, " has ",
               d.stiffness[i], " · ", dt, " against ", d.damping[i], " at component ", i,
               ": use integrator 'exponential', or a shorter step");
  }
  void sliding_friction(double mu, const ModelData& model) const {
    if (!(mu > 0)) reject("sliding_friction must be positive (infinite: none), but node ", index, " has ", mu);
    if (std::isinf(mu)) return;
    if (model.kind != Kind::force_feedback || model.contact_dim < 3)
      reject("sliding_friction needs kind 'force_feedback' with contact_dim 3 or 6, but node ", index, " has ", mu);
    if (model.integrator == Integrator::exponential)
      reject("sliding_friction needs integrator 'euler': 'exponential' solves the contact without it, but node ", index,
             " has ", mu);
  }
  void interval(const char* name, const double* lower, const double* upper, int count) const {
    for (int i = 0; i < count; ++i)
      if (!(lower[i] <= upper[i]))
        reject(name, "_lower must not exceed ", name, "_upper, but node ", index, " has ", lower[i], " > ", upper[i],
               " at component ", i);
  }
};

}  // namespace

void validate(const ChainData& c) {
  for (int i = 0; i < c.dof; ++i) {
    const double* a = c.axis[i];
    if (!is_rotation(c.rotation[i])) reject("rotations[", i, "] is not a rotation matrix");
    if (!(std::abs(a[0] * a[0] + a[1] * a[1] + a[2] * a[2] - 1) < 1e-6))
      reject("axes[", i, "] must have length 1, got (", a[0], ", ", a[1], ", ", a[2], ")");
    if (!(c.mass[i] >= 0) || !std::isfinite(c.mass[i])) reject("masses[", i, "] must not be negative, got ", c.mass[i]);
    if (!(c.rotor_inertia[i] >= 0)) reject("rotor_inertia[", i, "] must not be negative, got ", c.rotor_inertia[i]);
    if (!(c.joint_damping[i] >= 0)) reject("joint_damping[", i, "] must not be negative, got ", c.joint_damping[i]);
    if (!all_finite(c.translation[i], 3) || !all_finite(c.com[i], 3) || !all_finite(c.inertia[i], 9))
      reject("the data of joint ", i, " must be finite");
  }
  if (!is_rotation(c.tool_rotation)) reject("tool_rotation is not a rotation matrix");
  if (!is_rotation(c.contact_rotation)) reject("contact_rotation is not a rotation matrix");
  if (!all_finite(c.gravity, 3) || !all_finite(c.tool_translation, 3) || !all_finite(c.contact_translation, 3))
    reject("gravity, tool_translation and contact_translation must be finite");
}

void validate(const ModelData& m) {
  const bool free = m.kind == Kind::free;
  if (free ? m.contact_dim != 0 : m.contact_dim != 1 && m.contact_dim != 3 && m.contact_dim != 6)
    reject("contact_dim must be ", free ? "0 for kind 'free'" : "1, 3 or 6", ", got ", m.contact_dim);
  if (!(m.torque_bandwidth > 0)) reject("torque_bandwidth must be positive, got ", m.torque_bandwidth, " Hz");
  if (!(m.baumgarte_position >= 0) || !(m.baumgarte_velocity >= 0)) reject("baumgarte gains must not be negative");
}

void validate(const NodeData& d, int index, int dof, const ModelData& model, double dt) {
  const NodeCheck check{index};
  check.weights("state_weight", d.state_weight, 2 * dof);
  check.weights("control_weight", d.control_weight, dof);
  check.weights("torque_gravity_weight", d.torque_gravity_weight, dof);
  check.weights("control_gravity_weight", d.control_gravity_weight, dof);
  check.weights("translation_weight", d.translation_weight, 3);
  check.weights("rotation_weight", d.rotation_weight, 3);
  check.weights("velocity_weight", d.velocity_weight, 6);
  check.references("state_reference", d.state_reference, 2 * dof);
  check.references("control_reference", d.control_reference, dof);
  check.references("translation_reference", d.translation_reference, 3);
  check.references("velocity_reference", d.velocity_reference, 6);
  check.rotation("task_rotation", d.task_rotation);
  check.rotation("rotation_reference", d.rotation_reference);
  check.interval("torque", d.torque_lower, d.torque_upper, dof);
  const int m = model.contact_dim;
  check.weights("force_weight", d.force_weight, m);
  check.weights("force_rate_weight", d.force_rate_weight, m);
  check.references("force_reference", d.force_reference, m);
  check.interval("force", d.force_lower, d.force_upper, m);
  if (!(d.friction >= 0)) reject("friction must not be negative, but node ", index, " has ", d.friction);
  check.sliding_friction(d.sliding_friction, model);
  if (!d.contact_active) return;
  if (model.kind == Kind::force_feedback || model.kind == Kind::naive_viscoelastic) {
    check.positive("stiffness", d.stiffness, m);
    check.positive("damping", d.damping, m);
  }
  if (model.kind == Kind::force_feedback && model.integrator == Integrator::euler) check.explicit_step(d, m, dt);
  check.references("anchor_translation", d.anchor_translation, 3);
  if (m == 6) check.rotation("anchor_rotation", d.anchor_rotation);
}

}  // namespace pliant::mpc
