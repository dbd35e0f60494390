// Extension module pliant._plant.
#include "../shared/contract.hpp"
#include "bind_imperfect_robot.hpp"
#include "bind_physics.hpp"
#include "bind_truth.hpp"
#include "bind_world.hpp"

using namespace pliant::plant;

NB_MODULE(_plant, m) {
  pliant::agree(m, "_plant");
  m.attr("MUJOCO_VERSION") = mjVERSION_HEADER;
  m.def("same_layout", &same_layout, "model"_a, "data"_a);
  bind_truth(m);
  nb::class_<PyPhysics>(m, "Physics")
      .def(nb::init<nb::object, const std::vector<uintptr_t>&, int, bool, Doubles, Doubles, std::vector<int>,
                    std::vector<int>, std::vector<int>, const std::vector<SensorRow>&, const std::vector<PushRow>&>(),
           "model"_a, "functions"_a, "substeps"_a, "coriolis"_a, "limit"_a, "fastest"_a, "frame_of_geom"_a,
           "frame_site"_a, "frame_of_slot"_a, "sensors"_a, "pushes"_a)
      .def_prop_ro("outcome_size", [](const PyPhysics& p) { return p.physics().outcome_size(); })
      .def("step", &PyPhysics::step, "data"_a, "torque"_a, "pushes"_a, "out"_a.noconvert())
      .def("hold", &PyPhysics::hold, "data"_a, "torque"_a, "pushes"_a, "out"_a.noconvert())
      .def("read", &PyPhysics::read, "data"_a, "force"_a, "point"_a, "out"_a.noconvert());
  nb::class_<PyImperfectRobot>(m, "ImperfectRobot")
      .def("__init__", &init_imperfect_robot, nb::kw_only(), "n"_a, "frames"_a, "ticks"_a, "inner"_a, "under_way"_a,
           "limit"_a, "dry"_a, "viscous"_a, "noise"_a, "friction_velocity"_a, "kept"_a, "loop"_a, "ripple"_a, "late"_a,
           "noise_q"_a, "noise_v"_a, "noise_torque"_a, "noise_wrench"_a)
      .def_prop_ro("memory_size", &PyImperfectRobot::memory_size)
      .def_prop_ro("draws", &PyImperfectRobot::draws)
      .def_prop_ro("reading_size", &PyImperfectRobot::reading_size)
      .def("init", &PyImperfectRobot::init, "memory"_a.noconvert(), "held"_a, "gain"_a, "bias"_a, "sensor_gain"_a,
           "sensor_offset"_a, "now"_a, "draw"_a, "out"_a.noconvert())
      .def("drive", &PyImperfectRobot::drive, "memory"_a.noconvert(), "command"_a, "asked"_a.noconvert())
      .def("gear", &PyImperfectRobot::gear, "memory"_a.noconvert(), "draw"_a, "index"_a, "torque"_a.noconvert())
      .def("moved", &PyImperfectRobot::moved, "memory"_a.noconvert(), "v"_a)
      .def("sense", &PyImperfectRobot::sense, "memory"_a.noconvert(), "draw"_a, "now"_a, "out"_a.noconvert())
      .def("period", &PyImperfectRobot::period, "memory"_a.noconvert(), "draws"_a, "robot"_a, "data"_a, "command"_a,
           "pushes"_a, "out"_a.noconvert());
  bind_world(m);
}
