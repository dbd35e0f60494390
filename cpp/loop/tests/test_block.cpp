// Blocks of ticks: they end before a tick that is not as usual and leave the memory as it was, they end with the robot,
// and they take nothing from the heap.
#include "../block.hpp"

#include "../../tests/checks.hpp"

namespace {

using namespace pliant::testing;
using namespace pliant;
using loop::Block;

// A row: time, position; true position; reference; estimate; torque.
enum { kTime, kPosition, kTrue, kReference, kEstimate, kTorque, kWidth };
constexpr int kTicks = 50;

// Counts its steps in its memory, and refuses one of them.
struct Counts : Part {
  int from, to, refuses;
  double factor;

  Counts(int reads, int writes, double times, int at) : from(reads), to(writes), refuses(at), factor(times) {}
  int memory_size() const override { return 1; }
  bool step(double* row, double* memory) override {
    if (int(memory[0]) == refuses) return false;
    memory[0] += 1;
    row[to] = factor * row[from] + row[kReference];
    return true;
  }
};

struct Slides : World {
  double position = 0, breaks = HUGE_VAL, stops = HUGE_VAL;

  void tell(double* row) const override { row[kTrue] = position; }
  bool step(const double* row, double* next) override {
    position += row[kTorque];
    next[kTime] = row[kTime] + 1;
    next[kPosition] = next[kTime] == breaks ? NAN : position;
    return next[kTime] != stops;
  }
};

struct Case {
  const char* name;
  int estimator, controller;  // steps that they refuse, -1: none
  double breaks, stops;       // times of readings that are no number, and of the robot's stop
  int broken;                 // tick whose reference is no number
  double most;                // N m
  int ticks;                  // that are wanted
  bool stopped;
};

void run(const Case& c) {
  Counts estimator(kPosition, kEstimate, 1.0, c.estimator), controller(kEstimate, kTorque, 0.5, c.controller);
  Slides world;
  world.breaks = c.breaks;
  world.stops = c.stops;
  Block block({kWidth, {{kTime, 2}}, {{kReference, 3}}, kTorque, {c.most}}, estimator, controller, world);
  std::vector<double> rows(size_t((kTicks + 1) * kWidth)), memory(2), wall(2 * kTicks);
  for (int i = 0; i < kTicks; ++i) rows[size_t(i * kWidth + kReference)] = i == c.broken ? HUGE_VAL : 1e-3;
  const int taken = allocations;
  const loop::Ran ran = block.run(rows.data(), kTicks, memory.data(), wall.data());
  check(allocations == taken, "a block takes nothing from the heap", c.name);
  check(ran.ticks == c.ticks, "a block ends where it has to", c.name);
  check(ran.stopped == c.stopped, "a block tells whether the robot stopped", c.name);
  for (const double steps : memory)
    check(int(steps) == c.ticks, "a tick that is left undone is not remembered", c.name);
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
  run({"as usual", -1, -1, never, never, -1, never, kTicks, false});
  run({"the estimator refuses", 7, -1, never, never, -1, never, 7, false});
  run({"the controller refuses", -1, 0, never, never, -1, never, 0, false});
  run({"a reading is no number", -1, -1, 9, never, -1, never, 9, false});
  run({"a reference is no number", -1, -1, never, never, 4, never, 4, false});
  run({"a torque is too large", -1, -1, never, never, -1, 1e-3, 0, false});
  run({"the robot stops", -1, -1, never, 12, -1, never, 12, true});
  return result();
}
