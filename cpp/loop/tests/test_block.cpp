// Blocks of ticks: they end before a tick that is not as usual and leave the memory as it was, they end with the robot,
// and they take nothing from the heap.
#include "../block.hpp"

#include "../../tests/checks.hpp"

namespace {

using namespace pliant::testing;
using namespace pliant;
using loop::Block;

// A row: time, position; true position; reference; estimate; torque; what is not known.
enum { kTime, kPosition, kTrue, kReference, kEstimate, kTorque, kUnknown, kWidth };
constexpr int kTicks = 50;

// Counts its steps in its memory and beyond it, and refuses one of them.
struct Counts : Part {
  int from, to, refuses, beyond = 0, begun = 0;
  double factor;

  Counts(int reads, int writes, double times, int at) : from(reads), to(writes), refuses(at), factor(times) {}
  int memory_size() const override { return 1; }
  void begin() override { begun = beyond; }
  void rewind() override { beyond = begun; }
  bool step(double* row, double* memory) override {
    ++beyond;
    if (int(memory[0]) == refuses) return false;
    memory[0] += 1;
    row[to] = factor * row[from] + row[kReference];
    return true;
  }
};

struct Slides : World {
  double position = 0, breaks = HUGE_VAL, stops = HUGE_VAL, still = -1;

  void tell(double* row) const override { row[kTrue] = position; }
  bool step(const double* row, double* next) override {
    position += row[kTorque];
    next[kTime] = row[kTime] + 1;
    next[kPosition] = next[kTime] == breaks ? NAN : next[kTime] == still ? row[kPosition] : position;
    return next[kTime] != stops;
  }
};

struct Case {
  const char* name;
  int estimator, controller;  // steps that they refuse, -1: none
  double breaks, stops;       // times of readings that are no number, and of the robot's stop
  int broken;                 // tick whose reference is no number
  double most;                // N m
  int learnt;                 // tick in which it becomes known, -1: none
  int still;                  // time of a reading that is equal to the one before, -1: none
  int ticks;                  // that are wanted
  bool stopped;
};

void run(const Case& c) {
  Counts estimator(kPosition, kEstimate, 1.0, c.estimator), controller(kEstimate, kTorque, 0.5, c.controller);
  Slides world;
  world.breaks = c.breaks;
  world.stops = c.stops;
  world.still = c.still;
  Block block(
      {kWidth, {{kTime, 2}}, {{kReference, 2}}, {{kTorque, 1}}, {{kPosition, 1}}, {kUnknown}, kTorque, {c.most}},
      estimator, controller, world);
  std::vector<double> rows(size_t((kTicks + 1) * kWidth)), memory(2), wall(2 * kTicks);
  for (int i = 0; i < kTicks; ++i) {
    rows[size_t(i * kWidth + kReference)] = i == c.broken ? HUGE_VAL : 1e-3;
    rows[size_t(i * kWidth + kUnknown)] = i == c.learnt ? 1.0 : NAN;
  }
  const int taken = allocations;
  const loop::Ran ran = block.run(rows.data(), kTicks, memory.data(), wall.data());
  check(allocations == taken, "a block takes nothing from the heap", c.name);
  check(ran.ticks == c.ticks, "a block ends where it has to", c.name);
  check(ran.stopped == c.stopped, "a block tells whether the robot stopped", c.name);
  for (const double steps : memory)
    check(int(steps) == c.ticks, "a tick that is left undone is not remembered", c.name);
  check(controller.beyond == c.ticks, "what a controller keeps beyond its memory is made again", c.name);
  double position = 0;
  for (int i = 0; i < ran.ticks; ++i) {
    const double* row = rows.data() + i * kWidth;
    check(row[kTime] == i, "every row has its time", c.name);
    check(row[kTrue] == position, "what is true stands in the row of its tick", c.name);
    position += row[kTorque];
    check(wall[size_t(2 * i)] >= 0 && wall[size_t(2 * i + 1)] >= 0, "times do not run back", c.name);
  }
  check(position == world.position, "the world has the ticks of the block and no more", c.name);
}

}  // namespace

int main() {
  constexpr double never = HUGE_VAL;
  run({"as usual", -1, -1, never, never, -1, never, -1, -1, kTicks, false});
  run({"the estimator refuses", 7, -1, never, never, -1, never, -1, -1, 7, false});
  run({"the controller refuses at once", -1, 0, never, never, -1, never, -1, -1, 0, false});
  run({"the controller refuses later", -1, 11, never, never, -1, never, -1, -1, 11, false});
  run({"a reading is no number", -1, -1, 9, never, -1, never, -1, -1, 9, false});
  run({"a reference is no number", -1, -1, never, never, 4, never, -1, -1, 4, false});
  run({"a torque is too large", -1, -1, never, never, -1, 1e-3, -1, -1, 0, false});
  run({"a torque becomes too large", -1, -1, never, never, -1, 3e-3, -1, -1, 2, false});
  run({"something becomes known", -1, -1, never, never, -1, never, 5, -1, 5, false});
  run({"a sensor stands still", -1, -1, never, never, -1, never, -1, 6, 6, false});
  run({"the robot stops", -1, -1, never, 12, -1, never, -1, -1, 12, true});
  return result();
}
