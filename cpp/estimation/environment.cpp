#include "environment.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

namespace pliant::estimation {

EnvironmentStage::EnvironmentStage(std::shared_ptr<const Tree> robot, std::string frame,
                                   std::shared_ptr<const Surface> surface, const EnvironmentFit& fit, double sliding,
                                   double reach, double kept)
    : robot_(std::move(robot)),
      name_(std::move(frame)),
      frame_(robot_->frame(name_)),
      surface_(std::move(surface)),
      fit_(fit),
      sliding_(sliding),
      reach_(reach),
      kept_(kept) {}

std::unique_ptr<Stage> EnvironmentStage::bound(int, Names& frames) const {
  auto made = std::make_unique<EnvironmentStage>(*this);
  const auto at = std::find(frames.begin(), frames.end(), name_);
  made->row_ = at == frames.end() ? -1 : int(at - frames.begin());
  made->bodies_.resize(size_t(robot_->n()));
  return made;
}

void EnvironmentStage::init(const Reading&, double* memory) const { std::fill(memory, memory + size(), 0.0); }

Refusal EnvironmentStage::step(const Reading&, Belief& belief, double* memory) {
  FitMemory fit;
  std::memcpy(&fit, memory, sizeof fit);
  if (row_ >= 0) {
    robot_->move(belief.q, belief.v, nullptr, bodies_.data());
    const Body at = robot_->at(frame_, bodies_.data());
    Vec3 normal;
    const double distance = surface_->near(at.pose.p, normal);
    const double rate = -dot(normal, at.velocity);
    const Environment before = fit.found;
    if (norm(at.velocity + rate * normal) <= sliding_)
      fit_.step(dot(normal, load(belief.wrenches + 6 * row_)), -distance, rate, fit);
    double* found_at = memory + fit_size;
    if (std::memcmp(&before, &fit.found, sizeof before) != 0) store(at.pose.p, found_at);
    if (fit.found.stiffness < kept_ && norm(at.pose.p - load(found_at)) > reach_) fit.known = 0;
    std::memcpy(memory, &fit, sizeof fit);
  }
  if (fit.known != 0) std::memcpy(belief.environment, &fit.found, sizeof fit.found);
  return {};
}

}  // namespace pliant::estimation
