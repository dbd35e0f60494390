// The state at which a solution takes effect: what was measured, rolled through the torques that are under way.
#pragma once
#include "settings.hpp"
#include "state.hpp"

namespace pliant::mpc::step {

// Rolls `x` (nx,) with the controller's own model through the torques under way, the disturbance added, and through
// those that averaging will still send. Force feedback moves its contact force along, λ̇ = −K ẋ − B ẍ ([FFMPC] eq. 18),
// never below zero along the normal; a rigid contact holds the tool where its phase says so. With a joint torque in the
// state, that follows the torque sent, with the difference that both had when they were measured.
void roll_ahead(const Settings& settings, bool touching, State& state, double* x);

}  // namespace pliant::mpc::step
