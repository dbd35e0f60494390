// The core without Python: arms that move at random, every law; bounds, balances, and nothing taken from the heap.
#include <cmath>
#include <limits>
#include <vector>

#include "../../tests/checks.hpp"
#include "../drive.hpp"
#include "../stack.hpp"

namespace pliant::impedance {
namespace {

using namespace pliant::testing;

constexpr int kJoints = 4;
constexpr double kPeriod = 1e-3;  // s

AxisConfig config(Law law) {
  AxisConfig c{{law, kPeriod, 0.1, 0.01, 50.0, 0.05, 0.05}, {}};
  c.account = {law == Law::Capped, kPeriod,     0.5,  1.0,  1.0,  0.5,   1.0, 1e-4,
               {0.01, 0.05},       {0.05, 0.2}, 1e-3, 0.01, 0.99, 0.999, 1e-3};
  return c;
}

void about_z(double angle, double* R) {
  const double c = std::cos(angle), s = std::sin(angle);
  const double rows[9] = {c, -s, 0, s, c, 0, 0, 0, 1};
  std::copy(rows, rows + 9, R);
}

// What one tick is told: poses that move at random, and a Jacobian that does not fit them.
void move(Noise& noise, double* q, double* J, std::vector<TaskInput>& input) {
  for (int j = 0; j < kJoints; ++j) q[j] += 1e-3 * noise();
  for (int i = 0; i < 6 * kJoints; ++i) J[i] = noise();
  for (TaskInput& in : input) {
    for (int i = 0; i < 3; ++i) {
      in.actual.position[i] += 1e-3 * noise();
      in.desired.position[i] = 0.05 * (i + 1);
    }
    about_z(0.5 * noise(), in.actual.rotation);
    about_z(3.1 * noise(), in.desired.rotation);  // up to a turn by π and over it
    in.actual.oriented = in.desired.oriented = true;
    in.retune = nullptr;
  }
}

void run_stack(Law law, Shape shape, const char* name) {
  const std::vector<double> limit(kJoints, 3.0);  // N m, less than is asked for
  const TaskConfig first{6, shape, {1e-3, 1e-2}, {1, 1, 1, 1}}, second{3, shape, {1e-3, 1e-2}, {1, 1, 0, 0}};
  Stack stack(config(law), limit, {first, second});
  // exactly as large as they are said to be: a sanitizer sees the first number beyond
  std::vector<double> memory(stack.state_size(), 0.0), out(stack.output_size());
  std::vector<double> q(kJoints, 0.0), J(6 * kJoints), bias(kJoints, 0.1);
  std::vector<std::vector<double>> tuning;
  for (int k : {6, 3}) {
    std::vector<double> values;
    for (double level : {800.0, 20.0, 0.05, 0.01}) values.insert(values.end(), k, level);
    tuning.push_back(values);
  }
  for (TaskInput& in : stack.input()) in = {};
  Noise noise;
  double balance = 0.0;
  const int before = allocations;
  for (int tick = 0; tick < 300; ++tick) {
    move(noise, q.data(), J.data(), stack.input());
    if (tick % 100 == 0) {
      for (int i = 0; i < 2; ++i) {
        tuning[i][0] += 100.0;
        stack.input()[i].retune = tuning[i].data();
      }
    }
    std::fill(out.begin(), out.end(), std::numeric_limits<double>::quiet_NaN());
    stack.step(memory.data(), out.data(), q.data(), J.data(), tick % 2 ? bias.data() : nullptr, stack.input());
    for (double value : out) check(std::isfinite(value), "every channel is written", name);
    for (int j = 0; j < kJoints; ++j) check(std::fabs(out[j]) <= limit[j], "a torque is within its limit", name);
    const double* e = out.data() + 2 * kJoints;
    const double sum = e[Stack::kSupplied] + e[Stack::kTuning] - e[Stack::kDelivered] - e[Stack::kDissipated];
    if (tick == 0) balance = e[Stack::kStored] - sum;
    if (law != Law::Capped)  // with the account, `stored` is its book's
      check(std::fabs(e[Stack::kStored] - sum - balance) < 1e-9, "the ledger closes", name);
  }
  check(allocations == before, "a tick takes nothing from the heap", name);
  std::vector<double> counted(3);
  check(allocations > before && counted.size() == 3, "the counter counts", name);  // baseline
}

// A spring is symmetric and gives back what it stored; a step of the error is felt at once.
void run_axis(Law law, Shape shape, const char* name) {
  constexpr int kSteps = 400, kTrials = 2;
  const Axis axis = make_axis(shape, 800.0, 20.0, 0.05, 0.01);
  std::vector<double> errors(kSteps * kTrials), forces(errors.size()), balances(errors.size());
  for (int k = 0; k < kSteps; ++k) {
    errors[k * kTrials] = 0.04 * std::sin(2.0 * kPi * k / 200.0);
    errors[k * kTrials + 1] = -errors[k * kTrials];
  }
  const int before = allocations;
  for (int i = 0; i < kTrials; ++i)
    drive(config(law), shape, axis, 1e-3, false, errors.data() + i, forces.data() + i, balances.data() + i, kSteps,
          kTrials);
  check(allocations == before, "an axis takes nothing from the heap", name);
  for (int k = 0; k < kSteps; ++k) {
    const double force = forces[k * kTrials];
    check(std::fabs(force) <= axis.force_max + 1e-9 || law != Law::Capped, "a force is within F_max", name);
    check(std::fabs(force + forces[k * kTrials + 1]) < 1e-12, "the law is odd", name);
    if (law == Law::Spring)
      check(std::fabs(std::fabs(force) - magnitude(shape, axis, std::fabs(errors[k * kTrials]))) < 1e-12,
            "a spring gives the profile's force", name);
  }
}

void run_profile(Shape shape, const char* name) {
  const Axis axis = make_axis(shape, 400.0, 20.0, 0.05, 0.01);
  for (double x : {0.002, 0.02, 0.045, 0.08}) {
    const double h = 1e-6;
    const double slope = (energy(shape, axis, x + h) - energy(shape, axis, x - h)) / (2.0 * h);
    check(std::fabs(slope - magnitude(shape, axis, x)) < 1e-5, "the force is the slope of the energy", name);
  }
}

void run() {
  run_profile(Shape::ExponentialPrinted, "exponential-printed");
  run_profile(Shape::TanhPrinted, "tanh-printed");
  for (Shape shape : {Shape::Exponential, Shape::Tanh}) {
    const char* name = shape == Shape::Tanh ? "tanh" : "exponential";
    run_profile(shape, name);
    for (Law law : {Law::Capped, Law::HapFic, Law::StackPrinted, Law::StackCorrected, Law::Spring}) {
      run_stack(law, shape, name);
      run_axis(law, shape, name);
    }
  }
}

}  // namespace
}  // namespace pliant::impedance

int main() {
  pliant::impedance::run();
  return pliant::testing::result();
}
