// The bound on torque steps: how much a torque may change in one period, and what it costs to hold the rest back.
#pragma once
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace pliant::guard {

class StepLimit {
 public:
  explicit StepLimit(std::vector<double> step_max) : step_max_(std::move(step_max)) {}

  int n() const { return int(step_max_.size()); }
  // The memory: joint positions of the last tick [rad], torque sent [N m], torque held back [N m], (n) each; then the
  // energy that the bound withheld from the robot [J].
  int memory_size() const { return 3 * n() + 1; }
  const double* held_back(const double* memory) const { return memory + 2 * n(); }
  double energy(const double* memory) const { return memory[3 * n()]; }

  // What came of a step: whether a part of the torque was held back, and what it would cost to hold it back over a step
  // of the joints like the last one [J].
  struct Outcome {
    bool held_back;
    double cost;
  };

  // Bounds a wanted torque (n).
  Outcome step(const double* wanted, const double* q, double* memory, double* torque) const {
    double *last = memory, *sent = last + n(), *held = sent + n();
    Outcome outcome{false, 0};
    double energy = 0;
    for (int j = 0; j < n(); ++j) {
      const double way = q[j] - last[j];
      energy += held[j] * way;
      torque[j] = std::min(std::max(wanted[j], sent[j] - step_max_[j]), sent[j] + step_max_[j]);
      held[j] = wanted[j] - torque[j];
      outcome.cost -= held[j] * way;
      outcome.held_back = outcome.held_back || held[j] != 0;
      last[j] = q[j];
    }
    memory[3 * n()] += energy;
    return outcome;
  }

  // After a step that held something back: gives way where that would cost more than may be spent [J]. Returns by how
  // much the bound is exceeded, as a share of it; 0: it is held.
  double give_way(const Outcome& outcome, double spendable, const double* wanted, double* memory,
                  double* torque) const {
    if (!(outcome.cost > spendable)) return 0;
    const double share = spendable / outcome.cost;
    const double* sent = memory + n();
    double* held = memory + 2 * n();
    double largest = 0;
    for (int j = 0; j < n(); ++j) {
      held[j] *= share;
      torque[j] = wanted[j] - held[j];
      largest = std::max(largest, std::abs(torque[j] - sent[j]) / step_max_[j]);
    }
    return std::max(largest - 1, 0.0);
  }

  // What is sent is what the next step begins with.
  void keep(const double* torque, double* memory) const { std::copy(torque, torque + n(), memory + n()); }

 private:
  std::vector<double> step_max_;  // N m, infinite where there is no bound
};

}  // namespace pliant::guard
