// What a predictive controller keeps between two steps. A copy is a state of its own.
#pragma once
#include <memory>

#include "../dispatch.hpp"
#include "horizon.hpp"

namespace pliant::mpc::step {

// An engine of the instruction set in use, owned.
class OwnedEngine {
 public:
  OwnedEngine(const ChainData& chain, const ModelData& model, const Options& options);
  OwnedEngine(const OwnedEngine&) = delete;
  OwnedEngine& operator=(const OwnedEngine&) = delete;
  ~OwnedEngine() { table->destroy(engine); }

  const KernelTable* table;
  Engine* engine;
};

// Numbers of a state; all of fixed size from the first step on.
struct Memory {
  double next_solve = 0;  // [s]
  double plan_time = 0;   // [s] of the state that the plan starts from
  bool has_plan = false;
  bool touching = false;  // whether the first node was in contact
  bool oriented = true;   // what the weights in the nodes were written for
  int failures = 0;       // solves in a row that left no usable solution
  int contact_nodes = 0;
  bool deadline_missed = false;
  double force_shift = 0;               // [N]
  double q[max_joints] = {};            // last finite ones
  double v[max_joints] = {};            //
  double disturbance[max_joints] = {};  //
  double posture[max_joints] = {};      // where the controller started
  double x0[3 * max_joints] = {};       // of the plan
  Report report = {};                   // of the last solve
  NodeData contact = {};                // in the prediction over the delay
};

// Series of a state; all of fixed length from the first step on.
struct Series {
  std::vector<double> torques;   // (N, n) of the plan
  std::vector<double> gain;      // (n, nx) of the plan
  std::vector<double> commands;  // (under_way + 1, n) sent, the oldest first
  std::vector<double> wanted;    // (averaged, n) before averaging, the newest last
  std::vector<double> path;      // (N+1, 3) predicted tool positions
  std::vector<double> forces;    // (N, m) predicted
  std::vector<NodeData> nodes;   // (N+1)
  std::vector<int> phases;       // (N+1) what the weights in the nodes were written for
};

// What a solver keeps: the plan and the multipliers of its bounds.
struct Kept {
  std::vector<double> xs, us, multipliers;
};

class State {
 public:
  State(const Settings& settings, double time, const double* q, const double* v, const double* torque_sent);
  State(const State& other);
  State(const Memory& memory, const Series& series, const Kept& kept, const ChainData& chain, const ModelData& model,
        const Options& options, double tick);
  State& operator=(const State&) = delete;

  Kept kept() const;
  void restore(const Kept& kept);

  Memory memory;
  Series series;
  ChainData chain;
  ModelData model;
  Options options;
  double tick;  // [s] step of the prediction over the delay
  OwnedEngine solver, prediction;
  // Scratch space of a step.
  std::vector<double> xs, us;
  Horizon horizon;
};

}  // namespace pliant::mpc::step
