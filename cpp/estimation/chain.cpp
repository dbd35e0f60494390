#include "chain.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace pliant::estimation {

Chain::Chain(const Stages& stages, int n, Names frames)
    : n_(n), readings_(int(frames.size())), frames_(std::move(frames)) {
  for (const auto& stage : stages) {
    stages_.push_back(stage->bound(n, frames_));
    size_ += stages_.back()->size();
  }
  scratch_.resize(size_t(size_));
}

Belief Chain::belief(double* out) const {
  double* wrenches = out + 4 * n_;
  return {out, out + n_, out + 2 * n_, wrenches, wrenches + 6 * rows(), out + 3 * n_, wrenches + 7 * rows()};
}

Refusal Chain::init(const Reading& reading, double* out, double* memory) {
  Belief found = belief(out);
  double *at = memory, *copy = scratch_.data();
  for (const auto& stage : stages_) {
    stage->init(reading, at);
    stage->begin(reading, found, at);
    std::copy(at, at + stage->size(), copy);
    if (const Refusal refusal = stage->step(reading, found, copy); refusal.fault != Fault::none) return refusal;
    at += stage->size();
    copy += stage->size();
  }
  return {};
}

Refusal Chain::step(const Reading& reading, double* out, double* memory) {
  Belief found = belief(out);
  std::fill(found.environment, found.environment + 4, std::numeric_limits<double>::quiet_NaN());
  for (const auto& stage : stages_) {
    if (const Refusal refusal = stage->step(reading, found, memory); refusal.fault != Fault::none) return refusal;
    memory += stage->size();
  }
  return {};
}

}  // namespace pliant::estimation
