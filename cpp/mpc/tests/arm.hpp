// An arm, models and parameters of nodes that the tests of the MPC core share.
#pragma once
#include <limits>

#include "../problem.hpp"

namespace pliant::mpc {

inline void identity(double* R) {
  for (int i = 0; i < 9; ++i) R[i] = i % 4 == 0;
}

// An arm of upright links 0.2 m long whose axes alternate between z and y.
inline ChainData arm(int dof) {
  ChainData c{};
  c.dof = dof;
  c.gravity[2] = -9.81;  // [m/s²]
  for (int i = 0; i < dof; ++i) {
    identity(c.rotation[i]);
    c.translation[i][2] = 0.2;  // [m]
    c.axis[i][i % 2 ? 1 : 2] = 1;
    c.mass[i] = 2.0;    // [kg]
    c.com[i][2] = 0.1;  // [m]
    for (int d = 0; d < 3; ++d) c.inertia[i][4 * d] = 0.01;
    c.rotor_inertia[i] = 0.05;  // [kg m²]
  }
  identity(c.tool_rotation);
  identity(c.contact_rotation);
  c.tool_translation[2] = c.contact_translation[2] = 0.1;
  return c;
}

inline ModelData model(Kind kind, int dim, Axes axes, Integrator integrator) {
  ModelData m{};
  m.kind = kind;
  m.contact_dim = dim;
  m.axes = axes;
  m.integrator = integrator;
  m.torque_bandwidth = 50;
  m.baumgarte_velocity = 10;
  return m;
}

inline NodeData parameters(int dof, const double* home, bool bounded) {
  const double inf = std::numeric_limits<double>::infinity();
  NodeData d{};
  identity(d.task_rotation);
  identity(d.rotation_reference);
  identity(d.anchor_rotation);
  for (int i = 0; i < dof; ++i) {
    d.state_reference[i] = home[i];
    d.state_weight[i] = 0.2;
    d.state_weight[dof + i] = 0.04;
    d.torque_gravity_weight[i] = 1e-4;
    d.control_gravity_weight[i] = 1e-6;
    d.torque_lower[i] = bounded ? -100 : -inf;
    d.torque_upper[i] = bounded ? 100 : inf;
  }
  for (int i = 0; i < 6; ++i) d.velocity_weight[i] = 0.05;
  for (int c = 0; c < max_contact; ++c) {
    d.force_weight[c] = 0.01;
    d.force_rate_weight[c] = 6e-7;
    d.stiffness[c] = 1e3;
    d.damping[c] = 1e2;
    d.force_lower[c] = bounded ? -3 : -inf;
    d.force_upper[c] = bounded ? 3 : inf;
  }
  d.force_reference[0] = 5;  // [N], beyond the bound
  d.friction = bounded ? 0.5 : inf;
  d.sliding_friction = inf;
  d.contact_active = true;
  return d;
}

}  // namespace pliant::mpc
