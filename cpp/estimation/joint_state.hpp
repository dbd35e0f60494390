// Joint positions from velocities and positions together (src/pliant/estimation/joint_state.py).
#pragma once
#include "stage.hpp"

namespace pliant::estimation {

class JointStateStage final : public Stage {
 public:
  explicit JointStateStage(double memory) : seconds_(memory) {}

  std::unique_ptr<Stage> bound(int n, Names&) const override;
  int size() const override { return 2 + 2 * n_; }
  void init(const Reading& reading, double* memory) const override;
  Refusal step(const Reading& reading, Belief& belief, double* memory) override;

 private:
  double seconds_;  // of memory
  int n_ = 0;
};

}  // namespace pliant::estimation
