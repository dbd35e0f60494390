// A simulated robot as the world of a loop without Python.
#pragma once
#include "../shared/part.hpp"
#include "bind_physics.hpp"
#include "truth.hpp"

namespace pliant::plant {

class SimulatedRobot final : public pliant::World {
 public:
  // Args: where a tick's row has its time and the command's torque, a period's outcome and what is true.
  struct Places {
    int time, torque, outcome, truth;
  };

  SimulatedRobot(const PyPhysics& physics, const TruthRow& truth, nb::object data, double period, Places at)
      : physics_(physics),
        truth_(truth),
        owner_(std::move(data)),
        data_(pointed<mjData>(owner_)),
        period_(period),
        at_(at) {}

  // A block begins after so many periods, with more pushes than the robot was made with.
  void begin(int64_t periods, const std::vector<PushRow>& more) {
    periods_ = periods;
    pushes_ = physics_.all_pushes(more);
  }
  int64_t touching() const { return touching_; }  // as of `PyPhysics.step`, after the last period

  void tell(double* row) const override { truth_.read(*data_, row + at_.truth); }
  bool step(const double* row, double* next) override {
    const Physics& physics = physics_.physics();
    std::uint64_t touching = 0;
    const bool goes_on = physics.step(data_, row + at_.torque, pushes_, physics.outcome(next + at_.outcome), touching);
    touching_ = goes_on ? static_cast<int64_t>(touching) : -1;
    next[at_.time] = double(++periods_) * period_;
    return goes_on;
  }

 private:
  const PyPhysics& physics_;
  const TruthRow& truth_;
  nb::object owner_;
  mjData* data_;
  double period_;
  Places at_;
  int64_t periods_ = 0, touching_ = 0;
  std::vector<Push> pushes_;
};

inline void build_world(SimulatedRobot* self, const PyPhysics& physics, const TruthRow& truth, nb::object data,
                        double period, const std::vector<int>& at) {
  expect(at.size(), 4, "at");
  new (self) SimulatedRobot(physics, truth, std::move(data), period, {at[0], at[1], at[2], at[3]});
}

inline void bind_world(nb::module_& m) {
  nb::module_::import_("pliant._loop");
  nb::class_<SimulatedRobot, pliant::World>(m, "SimulatedRobot")
      .def("__init__", &build_world, nb::keep_alive<1, 2>(), nb::keep_alive<1, 3>(), "physics"_a, "truth"_a, "data"_a,
           "period"_a, "at"_a)
      .def_prop_ro("touching", &SimulatedRobot::touching)
      .def("begin", &SimulatedRobot::begin, "periods"_a, "pushes"_a);
}

}  // namespace pliant::plant
