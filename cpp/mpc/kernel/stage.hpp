// The parameters of one node, brought into lanes once per solve; weights of running nodes carry the factor dt.
#pragma once
#include "chain.hpp"
#include "force_step.hpp"

namespace pliant::mpc::PLIANT_ISA {

struct alignas(64) Stage {
  Lanes q_reference, v_reference, q_weight, v_weight;
  Lanes u_reference, u_weight, torque_weight, control_weight;  // the last two about gravity under load
  Mat task;     // R_world_task: axes of translation and velocity costs, and of a contact with axes 'surface'
  bool turned;  // task is not the identity
  Vec translation_reference, translation_weight;
  Mat rotation_reference;
  Vec rotation_weight;
  Vec linear_reference, angular_reference, linear_weight, angular_weight;  // tool velocity
  double force_reference[max_contact], force_weight[max_contact], force_rate_weight[max_contact];
  double stiffness[max_contact], damping[max_contact];
  ForceStep step[max_contact];
  double sliding_friction;
  Vec anchor;
  Mat anchor_rotation;
  double dt;
  bool active, terminal;
  bool slides;  // the tangential force is limited by friction
};

struct Discretisation {
  double dt;
  double alpha;  // of the torque filter
  bool exponential;
  double inverse_inertia[max_contact];  // W, frozen, per contact axis
};

inline Lanes load_part(const double* values, int count, double factor) {
  Lanes r = zero();
  for (int i = 0; i < count; ++i) r.set(i, values[i] * factor);
  return r;
}

inline void make_stage(const NodeData& data, const ModelData& model, const Discretisation& disc, int dof, bool terminal,
                       Stage& s) {
  const double w = terminal ? 1 : disc.dt;
  s.terminal = terminal;
  s.dt = disc.dt;
  s.active = data.contact_active && model.contact_dim > 0;
  s.q_reference = load_part(data.state_reference, dof, 1);
  s.v_reference = load_part(data.state_reference + dof, dof, 1);
  s.q_weight = load_part(data.state_weight, dof, w);
  s.v_weight = load_part(data.state_weight + dof, dof, w);
  s.u_reference = load_part(data.control_reference, dof, 1);
  s.u_weight = load_part(data.control_weight, dof, w);
  s.torque_weight = load_part(data.torque_gravity_weight, dof, w);
  s.control_weight = load_part(data.control_gravity_weight, dof, w);
  s.task = mat(data.task_rotation);
  s.turned = !is_identity(s.task);
  s.translation_reference = vec(data.translation_reference);
  s.translation_weight = vec(data.translation_weight) * w;
  s.rotation_reference = mat(data.rotation_reference);
  s.rotation_weight = vec(data.rotation_weight) * w;
  s.linear_reference = vec(data.velocity_reference);
  s.angular_reference = vec(data.velocity_reference + 3);
  s.linear_weight = vec(data.velocity_weight) * w;
  s.angular_weight = vec(data.velocity_weight + 3) * w;
  s.anchor = vec(data.anchor_translation);
  s.anchor_rotation = mat(data.anchor_rotation);
  s.sliding_friction = data.sliding_friction;
  s.slides = s.active && isfinite(data.sliding_friction);
  for (int c = 0; c < model.contact_dim; ++c) {
    const double on = s.active ? w : 0;
    s.force_reference[c] = data.force_reference[c];
    s.force_weight[c] = data.force_weight[c] * on;
    s.force_rate_weight[c] = data.force_rate_weight[c] * on;
    s.stiffness[c] = data.stiffness[c];
    s.damping[c] = data.damping[c];
    s.step[c] = disc.exponential ? exponential_step(s.stiffness[c], s.damping[c], disc.inverse_inertia[c], disc.dt)
                                 : euler_step(s.stiffness[c], s.damping[c]);
  }
}

}  // namespace pliant::mpc::PLIANT_ISA
