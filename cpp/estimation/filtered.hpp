// Low-pass filters of joint velocities, joint torques and contact wrenches.
#pragma once
#include <optional>

#include "low_pass.hpp"
#include "stage.hpp"

namespace pliant::estimation {

class FilteredStage final : public Stage {
 public:
  using Filter = std::optional<LowPass>;
  FilteredStage(Filter velocity, Filter torque, Filter wrench)
      : velocity_(velocity), torque_(torque), wrench_(wrench) {}

  std::unique_ptr<Stage> bound(int n, Names& frames) const override;
  int size() const override;
  void init(const Reading& reading, double* memory) const override;
  Refusal step(const Reading& reading, Belief& belief, double* memory) override;

 private:
  Filter velocity_, torque_, wrench_;
  int n_ = 0, frames_ = 0;
};

}  // namespace pliant::estimation
