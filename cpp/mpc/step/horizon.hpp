// What the task asks at each node of the horizon.
#pragma once
#include "data.hpp"
#include "settings.hpp"

namespace pliant::mpc::step {

// References of one node.
struct NodeReference {
  double position[3], velocity[6], wrench[6];
  double rotation[9], task_rotation[9], posture[max_joints];
  int phase;
};

// References along the horizon, and which of them there are.
struct Horizon {
  std::vector<NodeReference> nodes;
  bool oriented, turning, postured;  // rotation, task_rotation, posture
};

// Fills the horizon: from a preview, each node at its own time, its phase too; else the task goes on with its velocity.
// Vectors between two samples are interpolated, orientations and phases hold until the next sample.
Fault along_horizon(const Settings& settings, const Wanted& wanted, Horizon& horizon);

// Axes of the contact force at a node; `rotation` of the contact frame and `task_rotation` may be null.
const double* contact_axes(const Settings& settings, const double* rotation, const double* task_rotation);

// Components of a wrench (6,) in the world that the model knows, in contact axes.
void in_contact_axes(const Settings& settings, const double* wrench, const double* axes, double* out);

// The outward normal along which a force is regulated.
void normal_of(const Settings& settings, const double* task_rotation, double* normal);

}  // namespace pliant::mpc::step
