// A simulated robot as the world of a loop without Python.
#pragma once
#include "../shared/part.hpp"
#include "bind_imperfect_robot.hpp"
#include "bind_physics.hpp"
#include "truth.hpp"

namespace pliant::plant {

class SimulatedRobot : public pliant::World {
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

 protected:
  const PyPhysics& physics_;
  const TruthRow& truth_;
  nb::object owner_;
  mjData* data_;
  double period_;
  Places at_;
  int64_t periods_ = 0, touching_ = 0;
  std::vector<Push> pushes_;
};

// The same with imperfect sensors and actuators round it. Its outcome is a reading, then the robot's own.
class ImperfectWorld final : public SimulatedRobot {
 public:
  ImperfectWorld(const PyImperfectRobot& chain, const PyPhysics& physics, const TruthRow& truth, nb::object data,
                 double period, Places at, const Vector& memory)
      : SimulatedRobot(physics, truth, std::move(data), period, at), chain_(chain), memory_(memory) {}

  // Args: draws of every period to come, which are read where they lie.
  void draw(nb::object draws) {
    draws_ = nb::cast<ConstVector>(draws, false);
    drawn_ = std::move(draws);
    used_ = 0;
  }

  bool step(const double* row, double* next) override {
    const Settings& s = chain_.settings();
    const size_t taken = size_t(s.ticks) * size_t(chain_.draws());
    if (used_ + taken > draws_.size()) return false;
    const double* draw = draws_.data() + used_;
    used_ += taken;
    touching_ =
        chain_.run(memory_.data(), draw, physics_.physics(), data_, row + at_.torque, pushes_, next + at_.outcome);
    periods_ += s.ticks * s.inner;
    next[at_.time] = double(periods_) * period_;
    return touching_ >= 0;
  }

 private:
  const PyImperfectRobot& chain_;
  Vector memory_;
  nb::object drawn_;
  ConstVector draws_;
  size_t used_ = 0;
};

inline void build_imperfect(ImperfectWorld* self, const PyImperfectRobot& chain, const PyPhysics& physics,
                            const TruthRow& truth, nb::object data, double period, const std::vector<int>& at,
                            const Vector& memory) {
  expect(at.size(), 4, "at");
  expect(memory.size(), chain.memory_size(), "memory");
  new (self) ImperfectWorld(chain, physics, truth, std::move(data), period, {at[0], at[1], at[2], at[3]}, memory);
}

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
  nb::class_<ImperfectWorld, SimulatedRobot>(m, "ImperfectWorld")
      .def("__init__", &build_imperfect, nb::keep_alive<1, 2>(), nb::keep_alive<1, 3>(), nb::keep_alive<1, 4>(),
           nb::keep_alive<1, 8>(), "chain"_a, "physics"_a, "truth"_a, "data"_a, "period"_a, "at"_a,
           "memory"_a.noconvert())
      .def("draw", &ImperfectWorld::draw, "draws"_a);
}

}  // namespace pliant::plant
