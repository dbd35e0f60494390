// One frame that the stack holds: a pose error in, a wrench and the energies of its axes out.
#pragma once

#include "rotation.hpp"
#include "task_state.hpp"

namespace pliant::impedance {

class Task {
 public:
  // Channels of one task, in the order in which report() and step() write them: the wrench (6), rows (k) each, sums.
  static constexpr const char* kRowNames[] = {"force", "error",         "rate",           "rate_threshold",
                                              "phase", "turning_point", "storage_margin", "account"};
  static constexpr const char* kSumNames[] = {"energy_stored", "energy_supplied", "energy_dissipated", "energy_tuning",
                                              "moment_scale"};
  static constexpr int kRows = sizeof(kRowNames) / sizeof(kRowNames[0]);
  static constexpr int kSums = sizeof(kSumNames) / sizeof(kSumNames[0]);

  Task(const AxisConfig& axis, TaskConfig config) : axis_(axis), config_(std::move(config)) {}

  int axes() const { return config_.axes; }
  bool moves(int joint) const { return config_.moves[joint]; }
  int channels() const { return 6 + kRows * axes() + kSums; }

  TaskEnergies step(TaskState& state, const TaskInput& in, bool first, double* channel) const {
    const int k = axes();
    const bool oriented = k == 6 && in.desired.oriented;
    const double* now = in.axes ? in.axes : kWorld;
    if (first) std::copy(now, now + 9, state.axes);
    TaskMotion motion = motion_of(state, in, oriented, first);
    if (!first) book_supply(state, in.desired, oriented && state.oriented != 0.0);
    for (int i = 0; i < k; ++i) move_axis(state, in, motion, first, i);
    if (!std::equal(now, now + 9, state.axes)) turn(state, in, oriented, now, motion);
    double threshold[6];
    TaskEnergies sum{};
    for (int i = 0; i < k; ++i) {
      const AxisForce f =
          update_force(axis_, config_.shape, state.axis[i], state.state[i], motion.error[i], floor(i), i >= 3);
      threshold[i] = f.threshold;
      sum.spendable += f.spendable;
    }
    double* rows = channel + 6;
    rows[kRows * k + 4] = set_wrench(state, k, motion.error, channel);
    for (int i = 0; i < k; ++i) report(state, i, threshold[i], rows, sum);
    remember(state, in.desired, oriented);
    sum.supplied = state.supplied;
    const double sums[4] = {sum.stored, sum.supplied, sum.dissipated, sum.tuning};
    std::copy(sums, sums + 4, rows + kRows * k);
    return sum;
  }

 private:
  double floor(int i) const { return config_.rate_floor[i >= 3]; }

  TaskMotion motion_of(const TaskState& state, const TaskInput& in, bool oriented, bool first) const {
    TaskMotion m;
    errors(state.axes, in, oriented, m.error);
    double way[3];
    for (int i = 0; i < 3; ++i) way[i] = state.position[i] - in.actual.position[i];
    into_axes(state.axes, way, m.robot);
    if (first) return m;
    const bool same_axes = oriented == (state.oriented != 0.0);
    std::copy(m.error + 3, m.error + 6, m.robot + 3);
    if (!same_axes) {
      m.restarts = m.by_target = true;
    } else if (oriented) {
      if (!std::equal(state.rotation, state.rotation + 9, in.desired.rotation)) {
        double angle[3];
        log_difference(state.rotation, in.actual.rotation, angle);
        into_axes(state.axes, angle, m.robot + 3);
      }
      m.restarts = jumps(state, m.error);
      const bool robot_jumps = jumps(state, m.robot);
      m.by_target = !robot_jumps;
      if (robot_jumps && !m.restarts) std::copy(m.error + 3, m.error + 6, m.robot + 3);
    }
    if (axis_.account.active) share_work(state, m);
    return m;
  }

  // x̃ (6,) in a set of axes.
  static void errors(const double* axes, const TaskInput& in, bool oriented, double* error) {
    double way[3], angle[3] = {};
    for (int i = 0; i < 3; ++i) way[i] = in.desired.position[i] - in.actual.position[i];
    into_axes(axes, way, error);
    if (oriented) log_difference(in.desired.rotation, in.actual.rotation, angle);
    into_axes(axes, angle, error + 3);
  }

  // Other axes from now on: the last period was booked in the old ones. What the profiles store more in the new ones is
  // supplied by who turned them, as with a change of the tuning, and the axes start anew.
  void turn(TaskState& state, const TaskInput& in, bool oriented, const double* now, TaskMotion& motion) const {
    std::copy(now, now + 9, state.axes);
    errors(now, in, oriented, motion.error);
    for (int i = 0; i < axes(); ++i) {
      restart(axis_, config_.shape, state.axis[i], state.state[i], motion.error[i], 0.0, true);
    }
  }

  // The work of one axis is h times its motion. The torque was held in the joints, though, not the force at the frame,
  // and part of it may not have been sent: what is left over goes to the axes by the size of their work.
  void share_work(const TaskState& state, TaskMotion& m) const {
    double weight[6], total = 0.0, sum = 0.0;
    for (int i = 0; i < axes(); ++i) {
      const bool starts = m.restarts && i >= 3;
      m.work[i] = starts ? 0.0 : state.state[i].force * (m.robot[i] - state.state[i].error);
      weight[i] = m.restarts ? (starts ? 1.0 : 0.0) : std::fabs(m.work[i]);
      total += weight[i];
      sum += m.work[i];
    }
    for (int i = 0; i < axes(); ++i) m.work[i] += (state.work - sum) * (total > 0.0 ? weight[i] / total : 1.0 / axes());
  }

  void move_axis(TaskState& state, const TaskInput& in, const TaskMotion& m, bool first, int i) const {
    const Shape shape = config_.shape;
    Axis& p = state.axis[i];
    AxisState& s = state.state[i];
    const double error = m.error[i];
    if (first) {
      if (in.retune) p = tuned(in.retune, i);
      start(s, shape, p, error, floor(i), axis_.attractor);
      update_rate(axis_.attractor, s, error, floor(i));
      return;
    }
    if (m.restarts && i >= 3) {
      restart(axis_, shape, p, s, error, m.work[i], m.by_target);
    } else {
      book_motion(axis_, shape, p, s, error, {m.robot[i], m.work[i]}, floor(i));
    }
    if (in.retune) retune(axis_, shape, p, s, error, tuned(in.retune, i));
    push_error(s, error);
  }

  void report(const TaskState& state, int i, double threshold, double* rows, TaskEnergies& sum) const {
    const AxisState& s = state.state[i];
    const double stored = axis_.account.active ? s.account.stored : energy(config_.shape, state.axis[i], s.error);
    const double margin = s.absorbed + s.injected - (stored - s.energy_start);
    const double row[kRows] = {s.force, s.error, s.rate, threshold, s.converging, s.turning, margin, s.account.balance};
    for (int r = 0; r < kRows; ++r) rows[r * axes() + i] = row[r];
    sum.stored += stored;
    sum.absorbed += s.absorbed;
    sum.dissipated += margin;
    sum.tuning += s.injected;
  }

  Axis tuned(const double* retune, int i) const {
    const int k = axes();
    return make_axis(config_.shape, retune[i], retune[k + i], retune[2 * k + i], retune[3 * k + i]);
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

  // The wrench m = J_l^-1 h turns the robot, J_l^-T h meets the reference. J_l^-1 may lift the moment above F_max: then
  // all three h shrink by one factor, which keeps the moment conjugate to them. Returns the factor.
  double set_wrench(TaskState& state, int k, const double* error, double* wrench) const {
    double h[6] = {};
    for (int i = 0; i < k; ++i) h[i] = state.state[i].force;
    double turning[6] = {}, meets[6] = {};
    std::copy(h, h + 3, turning);
    std::copy(h, h + 3, meets);
    double scale = 1.0;
    if (k == 6) {
      left_jacobian_inverse_times(error + 3, h + 3, 1.0, turning + 3);
      left_jacobian_inverse_times(error + 3, h + 3, -1.0, meets + 3);
      if (axis_.account.active) scale = moment_scale(state, turning);
    }
    for (int i = 3; scale != 1.0 && i < 6; ++i) {
      state.state[i].force *= scale;
      turning[i] *= scale;
      meets[i] *= scale;
    }
    for (int part = 0; part < 6; part += 3) {
      into_world(state.axes, turning + part, wrench + part);
      into_world(state.axes, meets + part, state.supply + part);
    }
    return scale;
  }

  // Axes that are off have no bound of their own: they would let nothing of the others through.
  static double moment_scale(const TaskState& state, const double* wrench) {
    double scale = 1.0;
    for (int i = 3; i < 6; ++i) {
      const double bound = state.axis[i].force_max;
      if (bound > 0.0 && std::fabs(wrench[i]) * scale > bound) scale = bound / std::fabs(wrench[i]);
    }
    return scale;
  }

  static void remember(TaskState& state, const Pose& desired, bool oriented) {
    std::copy(desired.position, desired.position + 3, state.position);
    if (oriented) std::copy(desired.rotation, desired.rotation + 9, state.rotation);
    state.oriented = oriented ? 1.0 : 0.0;
  }

  AxisConfig axis_;
  TaskConfig config_;
};

}  // namespace pliant::impedance
