// A stack of fractal impedance tasks: pose errors in, joint torques and an energy ledger out. No allocation in step().
#pragma once

#include <vector>

#include "task.hpp"

namespace pliant::impedance {

class Stack {
 public:
  enum Energy { kStored, kSupplied, kDelivered, kDissipated, kTuning, kClamped, kSpendable, kEnergies };
  static constexpr const char* kEnergyNames[] = {"stored", "supplied", "delivered", "dissipated",
                                                 "tuning", "clamped",  "spendable"};
  static_assert(sizeof(kEnergyNames) / sizeof(kEnergyNames[0]) == kEnergies, "every energy has a name");
  static constexpr int kHeader = 2;  // whether it has begun, J kept back by clamps
  static constexpr int kTaskState = sizeof(TaskState) / sizeof(double);

  Stack(const AxisConfig& axis, std::vector<double> torque_limit, const std::vector<TaskConfig>& tasks)
      : limit_(std::move(torque_limit)), input_(tasks.size()) {
    for (const TaskConfig& task : tasks) tasks_.emplace_back(axis, task);
  }

  int joints() const { return static_cast<int>(limit_.size()); }
  int tasks() const { return static_cast<int>(tasks_.size()); }
  int axes(int task) const { return tasks_[task].axes(); }
  int state_size() const { return kHeader + 2 * joints() + (joints() + kTaskState) * tasks(); }
  int output_size() const {
    int size = 2 * joints() + kEnergies;
    for (const Task& task : tasks_) size += task.channels();
    return size;
  }
  // Where in the memory the torque (n) stands that was asked for and not sent. A layer outside that sends less adds to
  // it.
  int kept_back() const { return kHeader + joints(); }

  // memory (state_size) in and out, out (output_size), q (n), J (6, n) column-major joint Jacobian at the world's
  // origin, bias (n) added to the torque, or null.
  void step(double* memory, double* out, const double* q, const double* J, const double* bias,
            const std::vector<TaskInput>& input) const {
    const int n = joints();
    const bool first = memory[0] == 0.0;
    double* q_last = memory + kHeader;
    double* excess = memory + kept_back();
    double* shares = excess + n;  // (tasks, n) torque of each task
    auto* states = reinterpret_cast<TaskState*>(shares + n * tasks());
    double* torque = out;
    double* clamped = out + n;
    double* totals = clamped + n;
    for (int j = 0; j < n; ++j) torque[j] = bias ? bias[j] : 0.0;
    std::fill(totals, totals + kEnergies, 0.0);
    double* channel = totals + kEnergies;
    for (int i = 0; i < tasks(); ++i) states[i].work = 0.0;
    if (!first) book_work(q, q_last, excess, shares, states);
    for (int i = 0; i < tasks(); ++i) {
      add(tasks_[i].step(states[i], input[i], first, channel), totals);
      set_torque(tasks_[i], input[i].actual.position, channel, J, shares + i * n);
      for (int j = 0; j < n; ++j) torque[j] += shares[i * n + j];
      channel += tasks_[i].channels();
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
  // J that each task took in since the last tick: minus the sum of its torque, as sent, times the way of the joints.
  // What was kept back of a joint's torque is shared by the size of the tasks' torques.
  void book_work(const double* q, const double* q_last, const double* excess, const double* shares,
                 TaskState* states) const {
    const int n = joints();
    for (int j = 0; j < n; ++j) {
      const double way = q[j] - q_last[j];
      double total = 0.0;
      if (excess[j] != 0.0) {
        for (int i = 0; i < tasks(); ++i) total += std::fabs(shares[i * n + j]);
      }
      for (int i = 0; i < tasks(); ++i) {
        const double t = shares[i * n + j];
        const double part = excess[j] == 0.0 ? 0.0 : total > 0.0 ? std::fabs(t) / total : 1.0 / tasks();
        states[i].work -= (t - part * excess[j]) * way;
      }
    }
  }

  static void add(const TaskEnergies& e, double* totals) {
    totals[kStored] += e.stored;
    totals[kSupplied] += e.supplied;
    totals[kDelivered] -= e.absorbed;
    totals[kDissipated] += e.dissipated;
    totals[kTuning] += e.tuning;
    totals[kSpendable] += e.spendable;
  }

  // J^T wrench with J at the world's origin: the moment is moved there first.
  void set_torque(const Task& task, const double* p, const double* w, const double* J, double* torque) const {
    const double moment[3] = {w[3] + p[1] * w[2] - p[2] * w[1], w[4] + p[2] * w[0] - p[0] * w[2],
                              w[5] + p[0] * w[1] - p[1] * w[0]};
    for (int j = 0; j < joints(); ++j) {
      const double* c = J + 6 * j;
      torque[j] = task.moves(j)
                      ? c[0] * w[0] + c[1] * w[1] + c[2] * w[2] + c[3] * moment[0] + c[4] * moment[1] + c[5] * moment[2]
                      : 0.0;
    }
  }

  std::vector<double> limit_;
  std::vector<Task> tasks_;
  std::vector<TaskInput> input_;
};

}  // namespace pliant::impedance
