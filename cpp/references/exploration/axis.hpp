// Haptic exploration of one axis: its offset moves until the contact force is the desired one.
#pragma once
#include "retreat.hpp"
#include "span.hpp"

namespace pliant::references {

// As `AxisPhase` of src/pliant/references/exploration/rules.py.
enum class Phase { off = 0, free = 1, contact = 2, lost = 3 };

class Axis {
 public:
  double offset = 0.0;  // Δx, m or rad
  Phase phase = Phase::off;
  double stiffness = 0.0;  // K̂, N/m: change of force per motion of the target; 0 until the first step
  double reachable = 0.0;  // largest force that the bound of the offset allows, N
  bool unreachable = false;
  double clamped = 0.0;  // part of the desired force that exceeds F_max, N

  // Args: F_d, N; F, measured, N; x_d without the offset, m; s; s since the last step; whether F_d = 0 is a request:
  // the target then gives way until F is below the threshold of contact.
  void step(const Rules& rules, const Limits& limits, double desired, double force, double position, double time,
            double period, bool asked = false) {
    if (desired == 0.0 && !asked && offset == 0.0 && phase == Phase::off) {
      target_ = position;
      wanted_ = clamped = 0.0;
      filtered_ = force;
      return;
    }
    const double wanted = std::min(std::max(desired, -limits.force_max), limits.force_max);
    clamped = desired - wanted;
    if (std::abs(wanted) < std::abs(wanted_) - rules.contact_on) relief_ = kRelief;
    wanted_ = wanted;
    relief_ = std::max(relief_ - period, 0.0);
    feel(rules, force, period);
    switch_phase(rules, (wanted != 0.0 || asked) && limits.stiffness > 0.0, period);
    double free = 0.0;
    if (phase == Phase::contact) {
      free = offset + regulated(rules, limits, wanted, force, time, period) * period;
    } else {
      forget(limits.stiffness);
      free = returning(rules, wanted, period);
    }
    offset = std::min(std::max(free, -limits.range), limits.range);
    target_ = position + offset;
    diagnose(rules, limits, wanted, force, free, period);
  }

  // Holds the offset (there is no force signal), within its bound.
  void hold(const Limits& limits) { offset = std::min(std::max(offset, -limits.range), limits.range); }

 private:
  // A contact at rest shows at most K_0; a larger apparent stiffness is oscillation, which reduces the gain by up to
  // this factor.
  static constexpr double kCaution = 3.0;
  // s after a drop of F_d; a retreat at another time is a response to noise or oscillation and needs no special
  // handling.
  static constexpr double kRelief = 0.25;
  // Share of k_I in a retreat, which regulates the impedance's own spring and must wait for the timeout of its phases.
  static constexpr double kHaste = 2.0;

  bool touching_ = false;
  double filtered_ = 0.0, quiet_ = 0.0, absent_ = 0.0, at_bound_ = 0.0;
  double target_ = 0.0;  // last x_d + Δx, m
  Retreat retreat_;
  double wanted_ = 0.0;  // last F_d, clamped, N
  double relief_ = 0.0;  // s for which a retreat may still be a response to a drop of F_d
  SlidingSpan forces_, targets_;

  // Speed of the offset in contact, m/s.
  double regulated(const Rules& rules, const Limits& limits, double wanted, double force, double time, double period) {
    if (retreat_.began != 0.0 && stiffness < 0.5 * limits.stiffness) {
      retreat_.end();  // a soft contact that seemed stiff because of its damping
      retreat_.waived = true;
    }
    const double lasting = retreat_.lasting(force);
    if (retreat_.resting > 0.0) {
      forces_.clear();  // the impedance switches, so the force has no information about the contact
      targets_.clear();
    } else {
      learn(rules, limits.stiffness, lasting, time, period);
    }
    const double gain = retreat_.began != 0.0 ? kHaste * rules.gain : rules.gain;
    double rate = -gain * (wanted - lasting) / stiffness;
    const bool eased = relief_ > 0.0 && stiffness > 0.5 * limits.stiffness;
    rate = std::min(std::max(rate, -rules.speed), rules.speed);
    return wanted != 0.0 ? retreat_.rate(rules, rate, force, wanted, period, eased) : rate;
  }

  // Contact with hysteresis: a filtered force begins it, a force that stays low ends it.
  void feel(const Rules& rules, double force, double period) {
    const double share = period > 0.0 ? period / (rules.contact_filter + period) : 0.0;
    filtered_ += share * (force - filtered_);
    if (std::abs(filtered_) > rules.contact_on) {
      touching_ = true;
      quiet_ = 0.0;
    }
    if (std::abs(force) < rules.contact_off || std::abs(filtered_) < rules.contact_off) {
      quiet_ += period;
      if (quiet_ >= rules.release_time) touching_ = false;
    } else {
      quiet_ = 0.0;
    }
  }

  void switch_phase(const Rules& rules, bool active, double period) {
    if (!active) {
      phase = Phase::off;
    } else if (touching_) {
      phase = Phase::contact;
      absent_ = 0.0;
    } else if (phase == Phase::contact || phase == Phase::lost) {
      absent_ += period;
      phase = absent_ < rules.lost_time ? Phase::lost : Phase::free;
    } else {
      phase = Phase::free;
    }
  }

  // K̂ = span of the force / span of the target within the window; it starts at K_0, the stiffest there can be.
  //
  // Spans rather than differences: a contact that bounces, or a noisy force, then seems stiff, which reduces the gain.
  // With differences it could seem soft, and the higher gain would keep it bouncing.
  void learn(const Rules& rules, double ceiling, double force, double time, double period) {
    const double oldest = time - rules.window * (1.0 + 1e-9);
    const double change = forces_.add(time, force, oldest), moved = targets_.add(time, target_, oldest);
    if (stiffness <= 0.0) stiffness = ceiling;
    // With little motion the ratio is a lower bound: it may raise the estimate, not lower it.
    const double least = rules.least_motion;
    const double seen = std::min(std::max(change / std::max(moved, least), rules.stiffness_floor), kCaution * ceiling);
    if (moved > least || seen > stiffness) {
      if (seen < stiffness) {  // its inverse, to which the speed of the regulation is proportional, is filtered
        const double share = period / (rules.window + period);
        stiffness /= 1.0 + share * (stiffness / seen - 1.0);
      } else {  // the estimate rises faster than it falls
        stiffness += period / (0.25 * rules.window + period) * (seen - stiffness);
      }
    } else if (stiffness > ceiling) {
      stiffness += period / (rules.window + period) * (ceiling - stiffness);
    }
    stiffness = std::max(stiffness, std::min(rules.stiffness_floor, ceiling));
  }

  void forget(double ceiling) {
    if (phase == Phase::lost) return;
    stiffness = ceiling;
    forces_.clear();
    targets_.clear();
    retreat_.end();
  }

  // Offset of an axis that does not regulate.
  double returning(const Rules& rules, double wanted, double period) const {
    if (phase == Phase::lost || (phase == Phase::free && wanted == 0.0)) return offset;
    if (phase == Phase::free && rules.seek_speed > 0.0)
      return offset - std::copysign(rules.seek_speed * period, wanted);
    if (phase == Phase::free && !rules.reset) return offset;
    return std::copysign(std::max(std::abs(offset) - rules.reset_speed * period, 0.0), offset);
  }

  // Largest reachable force, and whether the offset stays at its bound while force is missing.
  void diagnose(const Rules& rules, const Limits& limits, double wanted, double force, double free, double period) {
    if (phase != Phase::contact) {
      reachable = limits.force_max;
      at_bound_ = 0.0;
      unreachable = false;
      return;
    }
    const double side = std::copysign(1.0, wanted), room = limits.range + side * offset;
    const double spring = std::min(stiffness, limits.stiffness);
    reachable = std::min(limits.force_max, std::max(side * force + spring * room, 0.0));
    const double missing = std::abs(wanted) - side * force;
    const bool stuck = side * free <= -limits.range && missing > rules.contact_off;
    at_bound_ = stuck ? at_bound_ + period : 0.0;
    unreachable = stuck && at_bound_ >= rules.unreachable_time;
  }
};

}  // namespace pliant::references
