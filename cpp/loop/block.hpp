// A block of ticks: estimate, command and world of each, one after the other, until something is not as usual.
#pragma once
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <utility>
#include <vector>

#include "../shared/part.hpp"

namespace pliant::loop {

struct Layout {
  int width = 0;                // numbers of a row
  std::vector<Span> measured;   // what must be finite before the estimator is stepped
  std::vector<Span> estimated;  // what must be finite before the controller is
  std::vector<Span> made;       // what must be finite after the controller was
  std::vector<Span> drawn;      // what noise makes different from the row before
  std::vector<int> unknown;     // what must be no number, after the estimator was stepped
  int torque = 0;               // where the command's torque begins
  std::vector<double> most;     // (n) [N m] that it may be; empty: there is no limit
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
    begin_.resize(before_.size());
    again_.resize(size_t(layout_.width));
  }

  int width() const { return layout_.width; }
  int memory_size() const { return estimator_.memory_size() + controller_.memory_size(); }

  // Runs up to so many ticks. rows (ticks + 1, width): the first measurement and all references stand in them already;
  // wall (ticks, 2): seconds up to the controller, and of it. A tick that Python has to look at is left as it was
  // before: its measurement is the first one that is not used, the memory that of the tick before.
  Ran run(double* rows, int ticks, double* memory, double* wall) {
    Ran ran;
    std::copy(memory, memory + before_.size(), begin_.data());
    controller_.begin();
    for (double* row = rows; ran.ticks < ticks && !ran.stopped; row += layout_.width, wall += 2) {
      if (!(row == rows || fresh(row)) || !sound(row, layout_.measured)) break;
      std::copy(memory, memory + before_.size(), before_.data());
      if (!tick(row, memory, wall)) {
        undo(rows, ran.ticks, memory);
        break;
      }
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
  bool stepped_ = false;                // whether the controller was, in this tick
  std::vector<double> before_, begin_;  // memories: before the tick, before the block
  std::vector<double> again_;           // a row

  static double seconds(Clock::duration taken) { return std::chrono::duration<double>(taken).count(); }

  bool tick(double* row, double* memory, double* wall) {
    const auto begin = Clock::now();
    auto planned = begin;
    stepped_ = false;
    if (!estimator_.step(row, memory) || !sound(row, layout_.estimated) || !as_unknown(row)) return false;
    planned = Clock::now();
    stepped_ = true;
    if (!controller_.step(row, memory + estimator_.memory_size())) return false;
    if (!sound(row, layout_.made) || !allowed(row + layout_.torque)) return false;
    wall[0] = seconds(planned - begin);
    wall[1] = seconds(Clock::now() - planned);
    return true;
  }
  // Leaves memories as they were before a tick: a controller that keeps something beyond its memory makes the block
  // again.
  void undo(const double* rows, int ticks, double* memory) {
    std::copy(before_.begin(), before_.end(), memory);
    if (!stepped_) return;
    const int own = estimator_.memory_size();
    controller_.rewind();
    std::copy(begin_.begin() + own, begin_.end(), memory + own);
    for (int i = 0; i < ticks; ++i, rows += layout_.width) {
      std::copy(rows, rows + layout_.width, again_.begin());
      controller_.step(again_.data(), memory + own);
    }
  }
  bool fresh(const double* row) const {
    for (const Span& span : layout_.drawn) {
      const double* now = row + span.begin;
      if (std::memcmp(now, now - layout_.width, size_t(span.size) * sizeof(double)) == 0) return false;
    }
    return true;
  }
  bool as_unknown(const double* row) const {
    for (const int place : layout_.unknown)
      if (row[place] == row[place]) return false;
    return true;
  }
  bool allowed(const double* torque) const {
    for (size_t j = 0; j < layout_.most.size(); ++j)
      if (!(std::abs(torque[j]) <= layout_.most[j])) return false;
    return true;
  }
};

}  // namespace pliant::loop
