// What a chain of estimators is made of. Every stage completes what the one before it believes; what it remembers is a
// few numbers of the chain's memory.
#pragma once
#include <memory>
#include <string>
#include <vector>

namespace pliant::estimation {

// A measurement; the wrenches are rows of 6 in the sensors' own axes.
struct Reading {
  double time;
  const double *q, *v, *torque, *torque_sent, *wrenches;
};

// Stiffness and damping of what a frame touches, with their standard uncertainties.
struct Environment {
  double stiffness, damping, stiffness_std, damping_std;
};

// An estimate; the wrenches are rows of 6 in world axes. A stage writes over what the stage before it wrote.
struct Belief {
  double *q, *v, *torque, *wrenches;
  double* touches;      // of each frame: 1 or 0
  double* disturbance;  // written by an observer
  double* environment;  // (4,) of one frame, NaN: not known
};

// Why there is no estimate; two numbers say more.
enum class Fault { none, out_of_order, moves_while_tared };
struct Refusal {
  Fault fault = Fault::none;
  double values[2] = {0, 0};
};

using Names = std::vector<std::string>;

class Stage {
 public:
  virtual ~Stage() = default;
  // Whether it asks anything in Python.
  virtual bool in_python() const { return false; }
  // A stage for n joints and wrenches of these names; leaves in `frames` the names of the wrenches that it gives.
  virtual std::unique_ptr<Stage> bound(int n, Names& frames) const = 0;
  // Of a bound stage: how many numbers it remembers.
  virtual int size() const = 0;
  virtual void init(const Reading& reading, double* memory) const = 0;
  // After `init` of every stage, with the belief of the first reading.
  virtual void begin(const Reading&, const Belief&, double*) {}
  virtual Refusal step(const Reading& reading, Belief& belief, double* memory) = 0;
};

// s since the last reading, or a refusal.
inline Refusal period_since(double before, double now, double& period) {
  period = now - before;
  if (period < 0) return {Fault::out_of_order, {now, before}};
  return {};
}

}  // namespace pliant::estimation
