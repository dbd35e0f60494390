// A stack of fractal impedance tasks: pose errors in, joint torques and an energy ledger out. No allocation in step().
#pragma once

#include <vector>

#include "attractor.hpp"
#include "rotation.hpp"

namespace pliant::impedance {

struct TaskConfig {
  int axes;  // 3, or 6 with rotation
  Shape shape;
  double rate_floor[2];  // m/s, rad/s
  std::vector<unsigned char> moves;  // (n) whether the joint moves the frame
};

struct Pose {
  double position[3];
  double rotation[9];  // R_world_frame, row-major
  bool oriented;
};

struct TaskState {
  double supplied;  // J, by the moving reference
  double oriented;  // whether the last reference had an orientation
  double position[3], rotation[9];  // of the last reference
  double supply[6];                 // wrench that the last reference worked against, N and N m
  Axis axis[6];
  AxisState state[6];
};

// Everything that is known of a tick before the state may change.
struct TaskInput {
  Pose actual, desired;
  const double* retune = nullptr;  // (4, axes): stiffness, force_max, range, linear_range
};

class Stack {
 public:
  enum Energy { kStored, kSupplied, kDelivered, kDissipated, kTuning, kClamped, kEnergies };
  static constexpr int kHeader = 2;
  static constexpr int kTaskState = sizeof(TaskState) / sizeof(double);

  Stack(AttractorConfig config, std::vector<double> torque_limit, std::vector<TaskConfig> tasks)
      : config_(config), limit_(std::move(torque_limit)), tasks_(std::move(tasks)), input_(tasks_.size()) {}

  int joints() const { return static_cast<int>(limit_.size()); }
  int tasks() const { return static_cast<int>(tasks_.size()); }
  int axes(int task) const { return tasks_[task].axes; }
  int state_size() const { return kHeader + 2 * joints() + kTaskState * tasks(); }
  int output_size() const {
    int size = 2 * joints() + kEnergies;
    for (const auto& task : tasks_) size += 6 + 7 * task.axes + 4;
    return size;
  }

  // memory (state_size) in and out, out (output_size), q (n), J (6, n) column-major joint Jacobian at the world's origin,
  // bias (n) added to the torque, or null.
  void step(double* memory, double* out, const double* q, const double* J, const double* bias,
            const std::vector<TaskInput>& input) const {
    const int n = joints();
    const bool first = memory[0] == 0.0;
    double* q_last = memory + kHeader;
    double* excess = q_last + n;
    auto* states = reinterpret_cast<TaskState*>(excess + n);
    double* torque = out;
    double* clamped = out + n;
    double* totals = clamped + n;
    for (int j = 0; j < n; ++j) torque[j] = bias ? bias[j] : 0.0;
    std::fill(totals, totals + kEnergies, 0.0);
    double* channel = totals + kEnergies;
    for (int i = 0; i < tasks(); ++i) {
      step_task(tasks_[i], states[i], input[i], first, channel, totals);
      add_torque(tasks_[i], input[i].actual.position, channel, J, torque);
      channel += 6 + 7 * tasks_[i].axes + 4;
    }
    totals[kDelivered] += totals[kSupplied];
    for (int j = 0; j < n; ++j) {
      if (!first) memory[1] += excess[j] * (q[j] - q_last[j]);
      const double wanted = torque[j];
      torque[j] = std::min(std::max(wanted, -limit_[j]), limit_[j]);
      excess[j] = clamped[j] = wanted - torque[j];
      q_last[j] = q[j];
    }
    totals[kClamped] = memory[1];
    memory[0] = 1.0;
  }

  std::vector<TaskInput>& input() { return input_; }

 private:
  void step_task(const TaskConfig& task, TaskState& state, const TaskInput& in, bool first, double* channel,
                 double* totals) const {
    const int k = task.axes;
    const bool oriented = k == 6 && in.desired.oriented;
    double error[6] = {};
    for (int i = 0; i < 3; ++i) error[i] = in.desired.position[i] - in.actual.position[i];
    if (oriented) log_difference(in.desired.rotation, in.actual.rotation, error + 3);
    const bool same_axes = !first && oriented == (state.oriented != 0.0);
    const bool relabelled = oriented && same_axes && jumps(state, error);
    if (!first) book_supply(state, in.desired, oriented && same_axes);

    double* wrench = channel;
    double* rows = channel + 6;  // force, error, rate, threshold, converging, turning, margin: (k) each
    double* sums = rows + 7 * k;  // stored, supplied, dissipated, tuning
    sums[0] = sums[2] = sums[3] = 0.0;
    double absorbed = 0.0;
    for (int i = 0; i < k; ++i) {
      Axis& p = state.axis[i];
      AxisState& s = state.state[i];
      const bool rotates = i >= 3;
      const double floor = task.rate_floor[rotates];
      const bool restart = rotates && (relabelled || !same_axes);
      if (first) {
        if (in.retune) p = tuned(task, in.retune, i);
        start(s, task.shape, p, error[i], floor, config_);
        update_rate(config_, s, error[i], floor);
      } else {
        step_error(task, p, s, in.retune, i, error[i], floor, restart);
      }
      const double threshold = rate_threshold(config_, s, floor);
      const bool converged = s.converging != 0.0;
      update_phase(config_, s, error[i], threshold);
      update_force(config_, task.shape, p, s, error[i], converged && s.converging == 0.0);
      const double stored = energy(task.shape, p, error[i]);
      const double margin = s.absorbed + s.injected - (stored - s.energy_start);
      const double row[7] = {s.force, error[i], s.rate, threshold, s.converging, s.turning, margin};
      for (int r = 0; r < 7; ++r) rows[r * k + i] = row[r];
      sums[0] += stored;
      sums[2] += margin;
      sums[3] += s.injected;
      absorbed += s.absorbed;
    }
    set_wrench(state, k, error, rows, wrench);
    remember(state, in.desired, oriented);
    sums[1] = state.supplied;
    totals[kStored] += sums[0];
    totals[kSupplied] += sums[1];
    totals[kDelivered] -= absorbed;
    totals[kDissipated] += sums[2];
    totals[kTuning] += sums[3];
  }

  // Books the work of the force held since the last tick, then a change of the tuning, then moves the error on.
  void step_error(const TaskConfig& task, Axis& p, AxisState& s, const double* retune, int i, double error, double floor,
                  bool restart) const {
    if (restart) {  // another branch of the logarithm, or another set of axes: the same pose, not a motion
      s.injected += energy(task.shape, p, error) - energy(task.shape, p, s.error);
      s.error = s.error_2 = s.error_3 = error;
      s.rate = s.blend = 0.0;
      diverge(s, error);
    } else {
      s.absorbed += s.force * (error - s.error);
      update_rate(config_, s, error, floor);
    }
    if (retune) {
      const double before = storage(config_, task.shape, p, s, error);
      p = tuned(task, retune, i);
      s.injected += storage(config_, task.shape, p, s, error) - before;
    }
    s.error_3 = s.error_2;
    s.error_2 = s.error;
    s.error = error;
  }

  static Axis tuned(const TaskConfig& task, const double* retune, int i) {
    const int k = task.axes;
    return make_axis(task.shape, retune[i], retune[k + i], retune[2 * k + i], retune[3 * k + i]);
  }

  // A rotation error that passes pi comes back from the other side.
  static bool jumps(const TaskState& state, const double* error) {
    double along = 0.0, size = 0.0;
    for (int i = 3; i < 6; ++i) {
      const double step = error[i] - state.state[i].error;
      size += step * step;
      along += error[i] * state.state[i].error;
    }
    return along < 0.0 && size > kPi * kPi;
  }

  static void book_supply(TaskState& state, const Pose& desired, bool rotates) {
    for (int i = 0; i < 3; ++i) state.supplied += state.supply[i] * (desired.position[i] - state.position[i]);
    if (!rotates) return;
    double turn[3];
    log_difference(desired.rotation, state.rotation, turn);
    for (int i = 0; i < 3; ++i) state.supplied += state.supply[3 + i] * turn[i];
  }

  static void set_wrench(TaskState& state, int k, const double* error, const double* h, double* wrench) {
    std::copy(h, h + 3, wrench);
    std::copy(h, h + 3, state.supply);
    std::fill(wrench + 3, wrench + 6, 0.0);
    if (k < 6) return;
    left_jacobian_inverse_times(error + 3, h + 3, 1.0, wrench + 3);         // m = J_l^-1 h turns the robot
    left_jacobian_inverse_times(error + 3, h + 3, -1.0, state.supply + 3);  // J_l^-T h meets the reference
  }

  static void remember(TaskState& state, const Pose& desired, bool oriented) {
    std::copy(desired.position, desired.position + 3, state.position);
    if (oriented) std::copy(desired.rotation, desired.rotation + 9, state.rotation);
    state.oriented = oriented ? 1.0 : 0.0;
  }

  // J^T wrench with J at the world's origin: the moment is moved there first.
  void add_torque(const TaskConfig& task, const double* p, const double* w, const double* J, double* torque) const {
    const double moment[3] = {w[3] + p[1] * w[2] - p[2] * w[1], w[4] + p[2] * w[0] - p[0] * w[2],
                              w[5] + p[0] * w[1] - p[1] * w[0]};
    for (int j = 0; j < joints(); ++j) {
      if (!task.moves[j]) continue;
      const double* c = J + 6 * j;
      torque[j] += c[0] * w[0] + c[1] * w[1] + c[2] * w[2] + c[3] * moment[0] + c[4] * moment[1] + c[5] * moment[2];
    }
  }

  AttractorConfig config_;
  std::vector<double> limit_;
  std::vector<TaskConfig> tasks_;
  std::vector<TaskInput> input_;
};

}  // namespace pliant::impedance
