#include "filtered.hpp"

namespace pliant::estimation {

std::unique_ptr<Stage> FilteredStage::bound(int n, Names& frames) const {
  auto made = std::make_unique<FilteredStage>(velocity_, torque_, wrench_);
  made->n_ = n;
  made->frames_ = int(frames.size());
  return made;
}

int FilteredStage::size() const {
  return 1 + 2 * ((velocity_ ? n_ : 0) + (torque_ ? n_ : 0) + (wrench_ ? 6 * frames_ : 0));
}

void FilteredStage::init(const Reading&, double* memory) const {
  for (int i = 0; i < size(); ++i) memory[i] = 0;
}

Refusal FilteredStage::step(const Reading&, Belief& belief, double* memory) {
  const bool fresh = memory[0] == 0;  // the filters start at the first values
  memory[0] = 1;
  double* at = memory + 1;
  const auto pass = [&](const Filter& filter, double* values, int count) {
    if (!filter) return;
    if (fresh) filter->init(values, count, at, at + count);
    filter->step(values, count, at, at + count);
    at += 2 * count;
  };
  pass(velocity_, belief.v, n_);
  pass(torque_, belief.torque, n_);
  pass(wrench_, belief.wrenches, 6 * frames_);
  return {};
}

}  // namespace pliant::estimation
