// Largest minus smallest value over a sliding window of time, at a constant cost per sample.
#pragma once
#include <deque>
#include <utility>

namespace pliant::references {

class SlidingSpan {
 public:
  void clear() {
    falling_.clear();
    rising_.clear();
  }

  // Takes a sample, drops those before `oldest`, s. Returns the span.
  double add(double time, double value, double oldest) {
    while (!falling_.empty() && falling_.back().second <= value) falling_.pop_back();
    while (!rising_.empty() && rising_.back().second >= value) rising_.pop_back();
    falling_.emplace_back(time, value);
    rising_.emplace_back(time, value);
    while (falling_.front().first < oldest) falling_.pop_front();
    while (rising_.front().first < oldest) rising_.pop_front();
    return falling_.front().second - rising_.front().second;
  }

 private:
  // (time, value) of candidates for the maximum and the minimum: each later one is smaller, or larger, than those
  // before it.
  std::deque<std::pair<double, double>> falling_, rising_;
};

}  // namespace pliant::references
