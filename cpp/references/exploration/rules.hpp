// Parameters of haptic exploration for one axis.
#pragma once
#include <stdexcept>
#include <vector>

namespace pliant::references {

// As `AxisRules` of src/pliant/references/exploration/rules.py has them, in its order; lengths in m or rad, forces in N
// or N·m.
struct Rules {
  static constexpr size_t kCount = 16;
  double gain = 0.0, speed = 0.0;
  bool reset = false;
  double reset_speed = 0.0, seek_speed = 0.0, stiffness_floor = 0.0, window = 0.0, least_motion = 0.0;
  double contact_on = 0.0, contact_off = 0.0, contact_filter = 0.0, release_time = 0.0, lost_time = 0.0;
  double unreachable_time = 0.0, turn_speed = 0.0, turn_time = 0.0;

  static Rules of(const std::vector<double>& all) {
    if (all.size() != kCount) throw std::invalid_argument("the rules of an axis are 16 numbers");
    return {all[0], all[1], all[2] != 0.0, all[3],  all[4],  all[5],  all[6],  all[7],
            all[8], all[9], all[10],       all[11], all[12], all[13], all[14], all[15]};
  }
};

// Impedance of the axis in its controller.
struct Limits {
  double stiffness = 0.0;  // K_0, N/m
  double force_max = 0.0;  // F_max, N
  double range = 0.0;      // x_b, m: bound of the offset
};

}  // namespace pliant::references
