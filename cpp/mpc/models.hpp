// What follows from the choice of a predictive model; outside the kernel, whose copies say it by their layouts.
#pragma once
#include "problem.hpp"

namespace pliant::mpc {

// Entries of the state beside positions and velocities: contact forces, or joint torques.
inline int extra_states(const ModelData& m, int dof) {
  return m.kind == Kind::force_feedback ? m.contact_dim : m.kind == Kind::torque_feedback ? dof : 0;
}

inline int state_dim(const ModelData& m, int dof) { return 2 * dof + extra_states(m, dof); }

// What moves the robot under torques that are known: with a joint torque in the state, the rigid model without it.
inline ModelData driven_model(ModelData m) {
  if (m.kind == Kind::torque_feedback) m.kind = Kind::classical;
  return m;
}

}  // namespace pliant::mpc
