// The imperfect robot: nothing is written beyond its memory, known answers of delay and clamp, a period that takes
// nothing from the heap.
#include "../imperfect_robot.hpp"

#include <algorithm>
#include <cmath>

#include "../../tests/checks.hpp"

namespace {

using namespace pliant::plant;
using pliant::testing::check;

constexpr int n = 3, frames = 2, six = 6 * frames;
const std::vector<double> zeros(n), ones(n, 1);

Settings settings(int late, int under_way) {
  Settings s;
  s.n = n;
  s.frames = frames;
  s.inner = 2;
  s.under_way = under_way;
  s.gears = {std::vector<double>(n, 10), zeros, zeros, zeros, 0.1, 0};
  s.loop.period = 1e-3;
  s.sensors = {late, late, late, zeros, zeros, zeros, {0, 0}};
  return s;
}

// A robot that moves at q = k, and what comes of it after `count` periods.
struct Run {
  std::vector<double> memory, out, asked, torque;

  Run(const Settings& s, double command, int count) {
    const ImperfectRobot robot(s);
    memory.resize(size_t(robot.memory_size()));
    out.resize(size_t(3 * n + six));
    asked.resize(n);
    torque.resize(n);
    const std::vector<double> draws(size_t(robot.draws())), wanted(n, command);
    std::vector<double> q(n), wrenches(six);
    const Reading reading = {out.data(), &out[n], &out[2 * n], &out[3 * n]};
    const True first = {q.data(), zeros.data(), zeros.data(), wrenches.data()};
    const Drawn drawn = {ones.data(), zeros.data(), ones.data(), zeros.data()};
    robot.init(memory.data(), zeros.data(), drawn, first, draws.data(), reading);
    const int before = pliant::testing::allocations;
    for (int k = 1; k <= count; ++k) {
      robot.ask(memory.data(), wanted.data(), asked.data());
      robot.drive(memory.data(), asked.data());
      for (int i = 0; i < s.inner; ++i) robot.gear(memory.data(), draws.data(), i, torque.data());
      robot.moved(memory.data(), zeros.data());
      std::fill(q.begin(), q.end(), k);
      std::fill(wrenches.begin(), wrenches.end(), 2 * k);
      robot.sense(memory.data(), draws.data(), {q.data(), zeros.data(), torque.data(), wrenches.data()}, reading);
    }
    used = pliant::testing::allocations - before;
  }
  int used = 0;
};

}  // namespace

int main() {
  for (const int late : {0, 1, 3}) {
    const Run run(settings(late, 0), 4, 20);
    check(run.out[0] == 20 - late, "positions are as late as they should be", "late");
    check(run.out[3 * n] == 2 * std::max(0, 20 - 2 * late), "wrenches come later still", "late");
    check(std::abs(run.torque[0] - 4) < 1e-12, "the torque asked for acts", "late");
  }
  const Run waiting(settings(0, 5), 4, 5), waited(settings(0, 5), 4, 6);
  check(waiting.asked[0] == 0 && waited.asked[0] == 4, "a command takes its time", "under way");
  check(Run(settings(0, 0), 40, 3).torque[n - 1] == 10, "no more than the limit acts", "limit");
  check(Run(settings(2, 2), 1, 50).used == 0, "a period takes nothing from the heap", "heap");
  return pliant::testing::result();
}
