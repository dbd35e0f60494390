// What a controller's step is told and gives, as flat structs that follow src/pliant/signals.py.
#pragma once
#include <vector>

#include "../../shared/rows.hpp"
#include "../problem.hpp"

namespace pliant::mpc::step {

using pliant::Rows;

struct Estimated {
  double time;  // [s]
  const double *q, *v;
  const double* torque;         // measured [N·m], with a model that has it in its state
  const double* wrench;         // (6,) of the contact frame, world axes; null: not estimated
  const double* disturbance;    // null: not estimated
  int contact;                  // 1: the frame touches, 0: it does not, -1: not estimated
  double stiffness;             // of the environment [N/m], negative: not estimated
  double damping, damping_std;  // of the same [N·s/m]
};

struct Task {
  const double *position, *rotation, *velocity, *wrench, *task_rotation;  // rotation, task_rotation may be null
};

constexpr int unnamed_phase = -1, unknown_phase = -2;

// The reference at later instants.
struct Ahead {
  int count = 0;
  Rows time, position, rotation, velocity, wrench, posture, task_rotation;  // rotation and the last two may be absent
  std::vector<int> phase;  // of each row: index among the phases, or unnamed; empty: all unnamed
};

struct Wanted {
  double time;  // [s]
  bool has_task, has_any;
  Task task;              // of the controlled frame
  Task first;             // the most important one
  const double* posture;  // may be null
  int phase;
  bool has_ahead;
  const Ahead* ahead;
};

enum class Source { plan, old_plan, gravity_and_damping };

struct Answer {
  double torque[max_joints], clamped[max_joints];
  Source source;
  bool solved;  // whether the results of a solve are new
};

// Why there is no answer; `node` says where along the horizon, `value` how much.
enum class Fault {
  none,
  no_wrench,
  no_disturbance,
  no_task,
  reference_not_finite,
  pulls,
  unknown_phase,
  no_phase_for_contact
};

struct Refusal {
  Fault fault = Fault::none;
  int node = 0;
  double value = 0;
  double normal[3] = {};
};

}  // namespace pliant::mpc::step
