// A block of ticks: estimate, command and world of each, one after the other, until something is not as usual.
#pragma once
#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>
#include <vector>

#include "../shared/part.hpp"

namespace pliant::loop {

struct Layout {
  int width = 0;               // numbers of a row
  std::vector<Span> measured;  // what must be finite before the estimator is stepped
  std::vector<Span> made;      // what must be finite after the controller was
  int torque = 0;              // where the command's torque begins
  std::vector<double> most;    // (n) [N m] that it may be; empty: there is no limit
};

struct Ran {
  int ticks = 0;         // that are complete
  bool stopped = false;  // whether the robot stopped in the period of the last one
};

// All numbers are finite and below 1e154, so that a sum of squares is.
inline bool sound(const double* row, const std::vector<Span>& spans) {
  double squares = 0;
  for (const Span& span : spans)
    for (int i = span.begin; i < span.begin + span.size; ++i) squares += row[i] * row[i];
  return std::isfinite(squares);
}

class Block {
 public:
  Block(Layout layout, Part& estimator, Part& controller, World& world)
      : layout_(std::move(layout)), estimator_(estimator), controller_(controller), world_(world) {
    before_.resize(size_t(memory_size()));
  }

  int width() const { return layout_.width; }
  int memory_size() const { return estimator_.memory_size() + controller_.memory_size(); }

  // Runs up to so many ticks. rows (ticks + 1, width): the first measurement and all references stand in them already;
  // wall (ticks, 2): seconds up to the controller, and of it. A tick that Python has to look at is left as it was
  // before: its measurement is the first one that is not used, the memory that of the tick before.
  Ran run(double* rows, int ticks, double* memory, double* wall) {
    Ran ran;
    for (double* row = rows; ran.ticks < ticks && !ran.stopped; row += layout_.width, wall += 2) {
      if (!tick(row, memory, wall)) break;
      world_.tell(row);
      ran.stopped = !world_.step(row, row + layout_.width);
      ++ran.ticks;
    }
    return ran;
  }

 private:
  using Clock = std::chrono::steady_clock;

  Layout layout_;
  Part &estimator_, &controller_;
  World& world_;
  std::vector<double> before_;  // a memory

  static double seconds(Clock::duration taken) { return std::chrono::duration<double>(taken).count(); }

  bool tick(double* row, double* memory, double* wall) {
    const auto begin = Clock::now();
    if (!sound(row, layout_.measured)) return false;
    std::copy(memory, memory + before_.size(), before_.data());
    auto planned = begin;
    const bool good = estimator_.step(row, memory) &&
                      (planned = Clock::now(), controller_.step(row, memory + estimator_.memory_size())) &&
                      sound(row, layout_.made) && allowed(row + layout_.torque);
    if (!good) {
      std::copy(before_.begin(), before_.end(), memory);
      return false;
    }
    wall[0] = seconds(planned - begin);
    wall[1] = seconds(Clock::now() - planned);
    return true;
  }
  bool allowed(const double* torque) const {
    for (size_t j = 0; j < layout_.most.size(); ++j)
      if (!(std::abs(torque[j]) <= layout_.most[j])) return false;
    return true;
  }
};

}  // namespace pliant::loop
