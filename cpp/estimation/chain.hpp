// A chain of estimators for one robot: measurement in, estimate out, and a row of numbers that remembers.
#pragma once
#include <algorithm>

#include "stage.hpp"

namespace pliant::estimation {

class Chain {
 public:
  using Stages = std::vector<std::shared_ptr<const Stage>>;
  // For n joints and wrenches of these names: those of the sensors, or, where somebody else's estimates are completed,
  // those that they have.
  Chain(const Stages& stages, int n, Names frames);
  Chain(const Chain&) = delete;
  Chain& operator=(const Chain&) = delete;

  int n() const { return n_; }
  int readings() const { return readings_; }       // wrenches that go in
  const Names& frames() const { return frames_; }  // wrenches that come out
  int memory_size() const { return size_; }
  int rows() const { return std::max(readings_, int(frames_.size())); }  // of wrenches in an estimate
  // Numbers of an estimate: q, v, torque, disturbance (n each), wrenches (rows, 6), touches (rows), environment (4).
  int belief_size() const { return 4 * n_ + 7 * rows() + 4; }
  Belief belief(double* out) const;

  // The memory before the first step. `belief` holds what is completed, if somebody else began; it is written over.
  Refusal init(const Reading& reading, double* belief, double* memory);
  // The next estimate. `belief` as in `init`.
  Refusal step(const Reading& reading, double* belief, double* memory);

 private:
  int n_, readings_, size_ = 0;
  Names frames_;
  std::vector<std::unique_ptr<Stage>> stages_;
  std::vector<double> scratch_;  // a memory
};

}  // namespace pliant::estimation
