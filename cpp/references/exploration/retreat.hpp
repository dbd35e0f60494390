// Release of a contact through a fractal impedance, in spite of its switching.
#pragma once
#include <algorithm>
#include <cmath>

#include "rules.hpp"

namespace pliant::references {

// Behaviour of a fractal impedance while its target retreats from a contact.
//
// It converges then: its force falls from F_m, at which the retreat began, by twice as much as its spring would, to
// F = 2 F_spring − F_m, and would push away beyond F = 0. When the error grows again it returns to the spring; at rest
// it does so after its own timeout. So the lasting force is (F + F_m)/2; a retreat ends when that is the desired one,
// or before F reaches zero, and it ends with a short step back towards the contact.
struct Retreat {
  static constexpr double kRest = 0.008;  // s in which the force of a rigid contact follows a jump of the impedance

  bool waived = false;   // needs no special handling: it began on a soft contact, which switching does not disturb
  double began = 0.0;    // F_m, N; 0 without a retreat
  double turning = 0.0;  // s that the step back may still last
  double left = 0.0;     // F when the step back began, N
  double resting = 0.0;  // s for which the target still waits until the impedance has returned to its spring

  void end() { *this = Retreat(); }

  // The force that the spring would give here, N.
  double lasting(double force) const { return began != 0.0 ? 0.5 * (force + began) : force; }

  // Motion of the target, m/s, given the one that the regulator asks for.
  double rate(const Rules& rules, double rate, double force, double wanted, double period, bool asked) {
    const double inward = std::copysign(rate, rate * wanted);
    if (resting > 0.0) {
      resting -= period;
      return 0.0;
    }
    if (turning > 0.0) return step_back(rules, force, wanted, period);
    if (began == 0.0) {
      if (inward > 2.0 * rules.turn_speed) {
        if (asked && !waived && rules.turn_time > 0.0) began = force;
        waived = true;
      } else if (inward < rules.turn_speed) {
        waived = false;
      }
      return rate;
    }
    const double least = std::max(0.1 * std::abs(began), rules.contact_on);
    if (inward < rules.turn_speed || std::abs(force) < least) {
      turning = rules.turn_time;
      left = force;
      return 0.0;
    }
    return rate;
  }

 private:
  double step_back(const Rules& rules, double force, double wanted, double period) {
    turning -= period;
    const bool returned = std::abs(force - left) > 0.5 * std::abs(lasting(left) - left);
    if (returned || turning <= 0.0) {
      end();
      resting = kRest;
      return 0.0;
    }
    return -std::copysign(rules.turn_speed, wanted);
  }
};

}  // namespace pliant::references
