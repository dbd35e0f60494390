// What stays the same during a run of a predictive controller.
#pragma once
#include <vector>

#include "../models.hpp"

namespace pliant::mpc::step {

// The costs of one phase: a row of weights for each node of the horizon.
struct Phase {
  std::vector<NodeData> nodes;
  bool contact;
};

struct Compensations {
  bool disturbance, environment;
  double force_integral;   // [1/s]
  double force_shift_max;  // [N]
  int under_way;           // periods between a reading and the effect of the command that answers to it
  int averaged;            // torques in the mean that is sent, at least 1
  int late;                // periods by which averaging delays a torque
  double lead;             // [s] from an estimate to the effect of the command that answers to it
  bool damping = false;    // the estimated one replaces the assumed one, too, where it is known well enough
};

struct Settings {
  ChainData chain;
  ModelData model;
  Options options;  // of the solver
  Limits limits;
  double period;         // [s] from solve to solve
  double tick;           // [s] from command to command
  bool riccati;          // between two solves the solver's feedback; else the torque is held
  double interpolation;  // ε of [FFMPC] eq. 15, where the torque is part of the state
  double max_gap;
  double fallback_damping;  // [N·m·s/rad]
  double deadline;          // [s], negative: none
  bool reference_posture, task_velocity, named_phases, torque_bounds;
  double torque_limit[max_joints];  // [N·m]
  double surface[9];                // R_world_surface
  double stiffness_max;             // [N/m]
  Compensations compensation;
  std::vector<NodeData> constants;  // (N+1) what the nodes hold before the first step
  std::vector<Phase> phases;

  int n() const { return chain.dof; }
  int m() const { return model.contact_dim; }
  int N() const { return options.horizon; }
  bool force_state() const { return model.kind == Kind::force_feedback; }
  bool torque_state() const { return model.kind == Kind::torque_feedback; }
  int nx() const { return state_dim(model, n()); }
  int normal() const { return m() == 1 ? 0 : 2; }  // index of the normal force among the contact's components
};

}  // namespace pliant::mpc::step
