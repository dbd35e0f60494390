// A step of a predictive controller: from estimate and reference to torque.
#pragma once
#include "data.hpp"
#include "horizon.hpp"
#include "settings.hpp"
#include "state.hpp"

namespace pliant::mpc::step {

// Solves the predictive problem every `period` and sends its first torque. Between two solves the torque is held, or
// follows the solver's own feedback. Without a usable solution the last usable plan is followed to its end; then
// gravity is compensated, with joint damping. No torque that is not finite leaves it, and nothing is allocated in a
// step.
class Controller {
 public:
  explicit Controller(Settings settings);

  const Settings& settings() const { return settings_; }

  // Whether a state is one of this controller, or of one of the same sizes.
  bool fits(const State& state) const;

  // Whether a step at this time solves, and so looks at the reference.
  bool due(double time, const State& state) const;

  // The torque of now. `wanted` may be null where no solve is due; its task rotation is `R_world_task`, which may be
  // null. Throws std::invalid_argument for references that are no rotations.
  Refusal step(const Estimated& estimate, const Wanted* wanted, const double* R_world_task, State& state,
               Answer& answer) const;

 private:
  Settings settings_;

  bool measured_state(const Estimated& e, const double* R_world_task, double* x) const;
  Refusal solve(const Estimated& e, const Wanted& w, const double* x, const double* R_world_task, State& state) const;
  Refusal require_pushing(const State& state) const;
  void integrate(const Estimated& e, const Wanted& w, State& state) const;
  void shift_forces(State& state) const;
  void write_environment(const Estimated& e, State& state) const;
  Refusal write_phases(const Estimated& e, State& state) const;
  void write_references(State& state) const;
  void write_anchor(const double* x, State& state) const;
  void keep_solution(const Estimated& e, State& state) const;
  Source wanted_torque(double time, const double* x, const State& state, double* torque) const;
  void send(const double* within, State& state, double* torque) const;
};

}  // namespace pliant::mpc::step
