// Stiffness and damping of what one frame touches, from its normal force and its motion.
#pragma once
#include "environment_fit.hpp"
#include "surface.hpp"
#include "../shared/tree.hpp"

namespace pliant::estimation {

using namespace bodies;

class EnvironmentStage final : public Stage {
 public:
  // Above the tangential speed `sliding` [m/s] nothing is learnt. Farther than `reach` [m] from where it was found, an
  // estimate softer than `kept` [N/m] is forgotten.
  EnvironmentStage(std::shared_ptr<const Tree> robot, std::string frame, std::shared_ptr<const Surface> surface,
                   const EnvironmentFit& fit, double sliding, double reach, double kept);

  std::unique_ptr<Stage> bound(int n, Names& frames) const override;
  bool in_python() const override { return surface_ && surface_->in_python(); }
  int size() const override { return fit_size + 3; }  // and where the estimate was found
  void init(const Reading& reading, double* memory) const override;
  Refusal step(const Reading& reading, Belief& belief, double* memory) override;

 private:
  std::shared_ptr<const Tree> robot_;
  std::string name_;
  Frame frame_;
  std::shared_ptr<const Surface> surface_;
  EnvironmentFit fit_;
  double sliding_, reach_, kept_;
  int row_ = -1;              // of the frame's wrench; -1: nobody gives it
  std::vector<Body> bodies_;  // scratch space
};

}  // namespace pliant::estimation
