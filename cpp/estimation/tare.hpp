// Taring: what the sensors read at the start of a run counts as what they carry (src/pliant/estimation/tare.py).
#pragma once
#include <vector>

#include "carried.hpp"
#include "stage.hpp"

namespace pliant::estimation {

struct TareSettings {
  bool wanted = false;
  double duration = 0;  // [s]
  bool weight = true;   // else all of it is bias
  double still = 0;     // [rad/s]
};

// A tare's numbers in a memory: start, count, whether it is found, and of each sensor the sums of readings (6) and
// gravity (3), then the load found (mass, centre, force, moment).
class TareMemory {
 public:
  static int size(int sensors) { return 3 + 19 * sensors; }
  explicit TareMemory(double* at) : at_(at) {}

  double& start() const { return at_[0]; }
  double& count() const { return at_[1]; }
  bool found() const { return at_[2] != 0; }
  void finish() const { at_[2] = 1; }
  double* sums(int sensor) const { return at_ + 3 + 19 * sensor; }
  double* load(int sensor) const { return sums(sensor) + 9; }

 private:
  double* at_;
};

// The load that a mean reading (force, moment) tells, with gravity in the sensor's axes.
Load tared(const TareSettings& tare, const Vec3& force, const Vec3& moment, const Vec3& gravity);

void store(const Load& load, double* to);  // mass, centre, force, moment: 10 numbers
Load load_of(const double* from);

}  // namespace pliant::estimation
