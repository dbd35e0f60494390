// A chain of every stage over a pendulum: what it believes of a still one, and that a step takes nothing from the heap.
#include "../chain.hpp"

#include <algorithm>
#include <cmath>

#include "../../tests/checks.hpp"
#include "../environment.hpp"
#include "../filtered.hpp"
#include "../joint_state.hpp"
#include "../momentum.hpp"
#include "../wrench.hpp"

namespace {

using namespace pliant;
using namespace pliant::estimation;
using pliant::testing::check;

const Pose here = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {}};
constexpr double mass = 2, length = 0.5, gravity = 9.81;  // [kg], [m], [m/s²]
constexpr int n = 2;

// Two joints about y, one behind the other; the masses hang along -z.
std::shared_ptr<const Tree> pendulum() {
  std::vector<Joint> joints;
  for (int i = 0; i < n; ++i)
    joints.push_back({i - 1,
                      {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, i ? -length : 0}},
                      {0, 1, 0},
                      false,
                      mass,
                      {0, 0, -length},
                      {},
                      0.1});
  return std::make_shared<Tree>(joints, std::vector<Frame>{{"tip", n - 1, here}, {"beyond", n - 1, here}},
                                Vec3{0, 0, -gravity});
}

Chain chain_of_all(bool tared) {
  const auto robot = pendulum();
  const auto table = std::make_shared<Plane>(Vec3{0, 0, -0.2}, Vec3{0, 0, 1});
  WrenchSettings felt;
  felt.begin = felt.end = 0.5;
  felt.contact_frames = {{"tip", "beyond"}};
  felt.acceleration_cutoff = 200;
  felt.carried["tip"].mass = 0.3;
  felt.tare = {tared, 5e-3, true, 0.1};
  const LowPass filter = {0.25, 0, 0, -0.75, 0};
  const FitSettings fit = {filter, 0.1, 0, 0, {0, 0}, 1, 300, 5, 1e9};
  ObserverSettings observer;
  observer.gain = 50;
  observer.along_normal = true;
  observer.surface = table;
  observer.late = 2;
  return Chain({std::make_shared<WrenchStage>(robot, felt), std::make_shared<FilteredStage>(filter, filter, filter),
                std::make_shared<JointStateStage>(0.1),
                std::make_shared<EnvironmentStage>(robot, "beyond", table, EnvironmentFit(fit), 10.0, 10.0, 1e9),
                std::make_shared<MomentumStage>(robot, observer)},
               n, {"tip"});
}

// Runs a chain; `angle` is that of the first joint, the second hangs.
void run(bool tared, bool moving) {
  Chain chain = chain_of_all(tared);
  std::vector<double> memory(size_t(chain.memory_size())), out(size_t(chain.belief_size()));
  testing::Noise noise;
  double q[n] = {0.3, -0.3}, v[n] = {}, torque[n] = {}, sent[n] = {}, wrench[6] = {};
  const Reading first = {0, q, v, torque, sent, wrench};
  check(chain.init(first, out.data(), memory.data()).fault == Fault::none, "a chain starts", "run");
  const int before = testing::allocations;
  for (int k = 0; k < 500; ++k) {
    if (moving && k > 20)
      for (int j = 0; j < n; ++j) {
        v[j] = noise();
        q[j] += 1e-3 * v[j];
      }
    for (double& w : wrench) w = noise();
    wrench[2] = 20 + 10 * noise();
    const Reading reading = {1e-3 * k, q, v, torque, sent, wrench};
    check(chain.step(reading, out.data(), memory.data()).fault == Fault::none, "a step answers", "run");
  }
  check(testing::allocations == before, "a step takes nothing from the heap", "run");
  const Belief found = chain.belief(out.data());
  check(std::all_of(out.begin(), out.end() - 4, [](double x) { return std::isfinite(x); }), "finite", "run");
  check(!moving || std::isfinite(found.environment[0]), "a moving tip feels the table", "run");
  check(found.touches[0] == 1, "it touches", "run");
}

// Without torque and contact a still pendulum is held by its disturbance: minus gravity's torque.
void observer_finds_gravity() {
  const auto robot = pendulum();
  ObserverSettings settings;
  settings.gain = 50;
  settings.surface = std::make_shared<Plane>(Vec3{}, Vec3{0, 0, 1});
  Chain chain(
      {std::make_shared<WrenchStage>(nullptr, WrenchSettings()), std::make_shared<MomentumStage>(robot, settings)}, n,
      {});
  std::vector<double> memory(size_t(chain.memory_size())), out(size_t(chain.belief_size()));
  const double q[n] = {0.3, -0.3}, zero[n] = {};
  chain.init({0, q, zero, zero, zero, nullptr}, out.data(), memory.data());
  for (int k = 0; k < 2000; ++k) chain.step({1e-3 * k, q, zero, zero, zero, nullptr}, out.data(), memory.data());
  const double* d = chain.belief(out.data()).disturbance;
  const double lever = length * std::sin(0.3);  // both masses hang that far out; the second one straight down
  check(std::abs(std::abs(d[0]) - 2 * mass * gravity * lever) < 1e-9, "gravity about the first joint", "gravity");
  check(std::abs(d[1]) < 1e-9, "none about the second", "gravity");
  const Refusal late = chain.step({0, q, zero, zero, zero, nullptr}, out.data(), memory.data());
  check(late.fault == Fault::out_of_order, "an old reading is refused", "gravity");
}

}  // namespace

int main() {
  for (const bool tared : {false, true})
    for (const bool moving : {false, true}) run(tared, moving);
  observer_finds_gravity();
  return pliant::testing::result();
}
