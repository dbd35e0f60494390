#include "joint_state.hpp"

#include <algorithm>

namespace pliant::estimation {

std::unique_ptr<Stage> JointStateStage::bound(int n, Names&) const {
  auto made = std::make_unique<JointStateStage>(seconds_);
  made->n_ = n;
  return made;
}

void JointStateStage::init(const Reading& reading, double* memory) const {
  memory[0] = reading.time;
  memory[1] = 0;  // readings
  std::copy(reading.q, reading.q + n_, memory + 2);
  std::copy(reading.v, reading.v + n_, memory + 2 + n_);
}

Refusal JointStateStage::step(const Reading& reading, Belief& belief, double* memory) {
  double period;
  if (const Refusal late = period_since(memory[0], reading.time, period); late.fault != Fault::none) return late;
  double *q = memory + 2, *v = q + n_;
  memory[0] = reading.time;
  memory[1] += 1;
  const double gain = std::min(1.0, std::max(period / seconds_, 1 / memory[1]));
  for (int j = 0; j < n_; ++j) {
    const double moved = q[j] + 0.5 * period * (v[j] + belief.v[j]);
    q[j] = moved + gain * (belief.q[j] - moved);
    v[j] = belief.v[j];
    belief.q[j] = q[j];
  }
  return {};
}

}  // namespace pliant::estimation
