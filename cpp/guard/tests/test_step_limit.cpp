// The bound on torque steps: it holds, gives way where it has to, writes nothing beyond its memory, and takes nothing
// from the heap.
#include "../step_limit.hpp"

#include "../../tests/checks.hpp"

namespace {

using namespace pliant::testing;
using pliant::guard::StepLimit;

constexpr int n = 4;

void run(double spendable, const char* name) {
  const std::vector<double> step_max{1, 2, 0.5, HUGE_VAL};
  const StepLimit limit(step_max);
  std::vector<double> memory(size_t(limit.memory_size())), torque(n), wanted(n), q(n), before(n);
  Noise noise;
  int held = 0, gave_way = 0;
  double energy = 0;
  const int taken = allocations;
  for (int tick = 0; tick < 500; ++tick) {
    for (int j = 0; j < n; ++j) {
      const double way = 1e-3 * noise();
      energy += limit.held_back(memory.data())[j] * way;
      q[size_t(j)] += way;
      wanted[size_t(j)] = before[size_t(j)] + (tick % 2 ? 0.2 : 5.0) * noise();
    }
    const StepLimit::Outcome outcome = limit.step(wanted.data(), q.data(), memory.data(), torque.data());
    double exceeded = 0;
    if (outcome.held_back) exceeded = limit.give_way(outcome, spendable, wanted.data(), memory.data(), torque.data());
    limit.keep(torque.data(), memory.data());
    for (size_t j = 0; j < n; ++j) {
      const double most = (1 + exceeded) * step_max[j] + 1e-12;
      check(std::abs(torque[j] - before[j]) <= most, "a step is within its bound", name);
      const double lost = limit.held_back(memory.data())[j];
      check(std::abs(wanted[j] - torque[j] - lost) < 1e-12, "what is not sent is held back", name);
    }
    check(std::abs(limit.energy(memory.data()) - energy) < 1e-9, "the work of what was held back is booked", name);
    std::copy(torque.begin(), torque.end(), before.begin());
    held += outcome.held_back;
    gave_way += exceeded > 0;
  }
  check(allocations == taken, "a step takes nothing from the heap", name);
  check(held > 100 && held < 500, "some torques are held back", name);  // baseline
  check((gave_way > 0) == (spendable < 1), "it gives way where it has to", name);
}

}  // namespace

int main() {
  run(HUGE_VAL, "nobody says what may be spent");
  run(1e3, "enough may be spent");
  run(0, "nothing may be spent");
  return result();
}
