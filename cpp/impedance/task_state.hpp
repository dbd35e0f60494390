// What a task is made of, told, and keeps between two ticks.
#pragma once

#include <vector>

#include "axis.hpp"

namespace pliant::impedance {

constexpr double kWorld[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};

struct TaskConfig {
  int axes;  // 3, or 6 with rotation
  Shape shape;
  double rate_floor[2];              // m/s, rad/s
  std::vector<unsigned char> moves;  // (n) whether the joint moves the frame
};

struct Pose {
  double position[3];
  double rotation[9];  // R_world_frame, row-major
  bool oriented;
};

struct TaskState {
  double work;      // J that the torque of this task, as it was sent, took in from the robot since the last tick
  double supplied;  // J, by the moving reference
  double oriented;  // whether the last reference had an orientation
  double position[3], rotation[9];  // of the last reference
  double supply[6];                 // wrench that the last reference worked against, N and N m
  double axes[9];                   // R_world_axes of the last tick
  Axis axis[6];
  AxisState state[6];
};

// Everything that is known of a tick before the state may change.
struct TaskInput {
  Pose actual, desired;
  const double* retune = nullptr;  // (4, axes): stiffness, force_max, range, linear_range
  const double* axes = nullptr;    // R_world_axes in which the axes are separate, row-major; null: the world's
};

// What a task adds to the totals of the stack.
struct TaskEnergies {
  double stored, supplied, absorbed, dissipated, tuning, spendable;
};

// Where the errors of a task stand, and what brought them there.
struct TaskMotion {
  double error[6] = {}, robot[6] = {};  // now; with the target of the last tick
  double work[6] = {};                  // J that each axis took in from the robot
  bool restarts = false;                // the rotation's axes start anew
  bool by_target = false;               // and it is the target that made them do so
};

}  // namespace pliant::impedance
