// Haptic exploration of one frame: its axes, or the one direction along the contact normal.
#pragma once
#include <array>
#include <optional>
#include <vector>

#include "axis.hpp"
#include "normal.hpp"

namespace pliant::references {

// One tick of Algorithm 1 of [HapFIC] Tiseo et al. 2021 exactly as printed, for comparison. Its faults: the step
// δ = σ F_d/K_0 carries the sign of F_d, so that a negative F_d runs the wrong way; σ is a share of a step and a
// threshold in newtons at once, and the band of 0.01 N lies below the force of one step, so that it limit-cycles; the
// reset fires when the force is reached; a step per tick makes the speed depend on the control rate.
//
// Args: F_d, N; F(t−1), N; Δx(t−1), m; its impedance; σ; the printed Reset. Returns Δx(t), m.
inline double printed_step(double desired, double force, double offset, const Limits& limits, double resolution,
                           bool reset) {
  const double step = limits.stiffness > 0.0 ? resolution * desired / limits.stiffness : 0.0;
  const double missing = desired - force;
  if (std::abs(missing) >= resolution && desired != 0.0) {
    if (std::abs(force) <= resolution) return 0.0;
    const double moved = offset - (missing > 0.0 ? step : missing < 0.0 ? -step : 0.0);
    return std::min(std::max(moved, -limits.range), limits.range);
  }
  return reset ? 0.0 : offset;  // printed without a clamp: if the bound shrinks, it is exceeded
}

// Parameters of a frame.
struct FrameRules {
  Rules linear, angular;
  std::array<bool, 6> asked{};  // whether F_d = 0 is a request
  bool printed = false;         // Algorithm 1 as printed
  bool normal = false;          // the target moves along the estimated contact normal only
  double resolution = 0.0;      // σ
  NormalRules turn;
};

class Frame {
 public:
  FrameRules rules;

  size_t count() const { return limits_.size(); }
  const std::vector<Axis>& axes() const { return axes_; }
  const std::array<double, 6>& offsets() const { return offsets_; }

  // New impedance of 3 or 6 axes: the offsets keep to its bound from now on.
  void limit(std::vector<Limits> limits) {
    limits_ = std::move(limits);
    for (size_t i = limits_.size(); i < 6; ++i) axes_[i] = Axis();
    bound();
  }
  // Other axes, in which the offsets are these: they begin anew.
  void begin(const std::array<double, 6>& offsets) {
    offsets_ = offsets;
    for (size_t i = 0; i < 6; ++i) {
      axes_[i] = Axis();
      axes_[i].offset = offsets[i];
    }
  }
  // There is no usable force signal.
  void hold() {
    for (size_t i = 0; i < limits_.size(); ++i) axes_[i].hold(limits_[i]);
    bound();
  }

  // Moves the offsets. Args: F_d and F (6), N and N·m; x_d without the offset (3), m; its velocity (3), m/s; s; s since
  // the last tick.
  void step(const double* desired, const double* measured, const double* position, const double* velocity, double time,
            double period) {
    size_t first = 0;
    if (rules.normal && !rules.printed) {
      step_normal(desired, measured, position, velocity, time, period);
      first = 3;
    }
    for (size_t i = first; i < limits_.size(); ++i) {
      Axis& axis = axes_[i];
      if (rules.printed)
        step_printed(axis, limits_[i], desired[i], measured[i]);
      else
        axis.step(i < 3 ? rules.linear : rules.angular, limits_[i], desired[i], measured[i], i < 3 ? position[i] : 0.0,
                  time, period, rules.asked[i]);
      offsets_[i] = axis.offset;
    }
  }

 private:
  std::vector<Axis> axes_ = std::vector<Axis>(6);
  Axis along_;  // the direction of the normal, if there is one
  std::optional<Direction> normal_;
  std::array<double, 6> offsets_{};  // Δx of every axis, m and rad
  std::vector<Limits> limits_;

  void bound() {
    for (size_t i = 0; i < 6; ++i) {
      const double range = i < limits_.size() ? limits_[i].range : 0.0;
      offsets_[i] = i < limits_.size() ? std::min(std::max(offsets_[i], -range), range) : 0.0;
    }
  }

  void step_printed(Axis& axis, const Limits& limits, double desired, double force) const {
    axis.offset = printed_step(desired, force, axis.offset, limits, rules.resolution, rules.linear.reset);
    const bool touching = std::abs(force) > rules.resolution;
    axis.phase = desired == 0.0 ? Phase::off : touching ? Phase::contact : Phase::free;
    axis.stiffness = limits.stiffness;
    axis.reachable = limits.force_max;
  }

  // One direction instead of three: |F_d| along the normal; the tangential axes follow the impedance.
  void step_normal(const double* desired, const double* measured, const double* position, const double* velocity,
                   double time, double period) {
    const Direction wanted{desired[0], desired[1], desired[2]}, force{measured[0], measured[1], measured[2]};
    const Direction place{position[0], position[1], position[2]}, way{velocity[0], velocity[1], velocity[2]};
    const double size = length_of(wanted);
    if (size > 0.0) turn({wanted[0] / size, wanted[1] / size, wanted[2] / size}, force, way, period);
    if (!normal_) return;
    const Direction& n = *normal_;
    along_.step(rules.linear, limits_along(n), size, dot(n, force), dot(n, place), time, period);
    // Slewed: neither a turning normal nor a change of mode makes the target jump.
    const double most = 2.0 * std::max(rules.linear.speed, rules.linear.reset_speed) * period;
    for (size_t i = 0; i < 3; ++i) {
      const double change = along_.offset * n[i] - offsets_[i];
      offsets_[i] += std::min(std::max(change, -most), most);
    }
    bound();
    for (size_t i = 0; i < 3; ++i) {
      Axis& axis = axes_[i];
      axis.offset = offsets_[i];
      axis.phase = along_.phase;
      axis.stiffness = along_.stiffness;
      axis.clamped = along_.clamped;
      axis.reachable = along_.reachable;
      axis.unreachable = along_.unreachable;
    }
  }

  void turn(const Direction& wanted, const Direction& force, const Direction& velocity, double period) {
    Direction normal = normal_.value_or(wanted);
    if (along_.phase == Phase::contact)
      normal = turned_normal(normal, force, velocity, rules.turn, period);
    else if (along_.phase == Phase::free && along_.offset == 0.0)
      normal = wanted;  // no contact, and nothing would jump
    normal_ = within_cone(normal, wanted, rules.turn.cone);
  }

  // Impedance along a direction: the bound and the force at which the first axis meets its own.
  Limits limits_along(const Direction& n) const {
    Limits found{0.0, 0.0, 0.0};
    bool any = false;
    for (size_t i = 0; i < 3; ++i) {
      const Limits& one = limits_[i];
      found.stiffness += one.stiffness * n[i] * n[i];
      const double share = std::abs(n[i]);
      if (share <= 1e-9) continue;
      found.force_max = any ? std::min(found.force_max, one.force_max / share) : one.force_max / share;
      found.range = any ? std::min(found.range, one.range / share) : one.range / share;
      any = true;
    }
    return found;
  }
};

}  // namespace pliant::references
