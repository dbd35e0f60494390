// Python face of a predictive controller's step and state.
#pragma once
#include <nanobind/stl/optional.h>
#include <nanobind/stl/tuple.h>

#include <memory>
#include <tuple>

#include "step.hpp"

namespace pliant::mpc::binding {

using PhaseRows = std::tuple<nb::object, bool, nb::object>;  // name, whether it has contact, nodes

inline nb::object nodes_copy(const std::vector<NodeData>& data, int dof, const ModelData& model) {
  auto* nodes = new PyNodes(int(data.size()), dof, model);
  nodes->data = data;
  return nb::cast(nodes, nb::rv_policy::take_ownership);
}

inline void init_step(PyStep* self, const PyChain& chain, const PyModel& model, const PyNodes& nodes,
                      const std::vector<PhaseRows>& phases, nb::str frame, nb::str contact_frame, double dt,
                      double period, double tick, double regularisation, bool bounds, int max_iterations,
                      double tolerance, std::optional<double> time_budget, std::optional<double> deadline, bool riccati,
                      double interpolation, double max_gap, double fallback_damping, nb::handle torque_limit,
                      nb::handle R_world_surface, double stiffness_max, bool reference_posture, bool task_velocity,
                      bool named_phases, bool torque_bounds, bool disturbance, bool environment, double force_integral,
                      double force_shift_max, int under_way, int averaged, int late, double lead,
                      bool environment_damping) {
  step::Settings s{};
  s.chain = chain.data;
  s.model = model.data;
  s.constants = nodes.data;
  s.options = {int(s.constants.size()) - 1, dt, regularisation, 8, 10, bounds};
  s.limits = {max_iterations, tolerance, time_budget.value_or(-1)};
  s.period = period;
  s.tick = tick;
  s.riccati = riccati;
  s.interpolation = interpolation;
  s.max_gap = max_gap;
  s.fallback_damping = fallback_damping;
  s.deadline = deadline.value_or(-1);
  s.reference_posture = reference_posture;
  s.task_velocity = task_velocity;
  s.named_phases = named_phases;
  s.torque_bounds = torque_bounds;
  s.stiffness_max = stiffness_max;
  s.compensation = {disturbance, environment, force_integral, force_shift_max,    under_way,
                    averaged,    late,        lead,           environment_damping};
  read(torque_limit, "torque_limit", {size_t(s.n())}, s.torque_limit);
  read(R_world_surface, "R_world_surface", {3, 3}, s.surface);
  if (s.N() < 1) throw std::invalid_argument("nodes must be two or more, got " + std::to_string(s.N() + 1));
  if (under_way < 0 || averaged < 1 || late < 0)
    throw std::invalid_argument("under_way and late must not be negative, averaged at least 1");
  if (!(dt > 0) || !(period > 0) || !(tick > 0)) throw std::invalid_argument("dt, period and tick must be positive");
  std::vector<nb::object> names;
  for (const auto& [name, contact, rows] : phases) {
    names.push_back(name);
    s.phases.push_back({nb::cast<const PyNodes&>(rows).data, contact});
    if (s.phases.back().nodes.size() != s.constants.size())
      throw std::invalid_argument("a phase must have as many nodes as the horizon");
  }
  new (self) PyStep(std::move(s), std::move(frame), std::move(contact_frame), std::move(names));
}

inline void restore_state(PyState* self, const nb::bytes& bytes) {
  StateParts p = from_bytes(std::string(bytes.c_str(), bytes.size()));
  new (self)
      PyState{step::State(p.memory, p.series, p.kept, p.chain, p.model, p.options, p.tick), step::Source::plan, {}, {}};
}

inline PyState* copy_state(const PyState& s) { return new PyState{step::State(s.state), s.source, {}, {}}; }

inline void bind_step(nb::module_& m) {
  nb::class_<PyState>(m, "ControllerState")
      .def_prop_ro("time_of_next_solve", [](const PyState& s) { return s.state.memory.next_solve; })
      .def_prop_ro("source", [](const PyState& s) { return int(s.source); })
      .def_prop_ro("failures", [](const PyState& s) { return s.state.memory.failures; })
      .def_prop_ro("force_shift", [](const PyState& s) { return s.state.memory.force_shift; })
      .def_prop_ro("channels", [](PyState& s) { return channels_of(s); })
      .def_prop_ro("nodes",
                   [](const PyState& s) { return nodes_copy(s.state.series.nodes, s.state.chain.dof, s.state.model); })
      .def_prop_ro(
          "contact",
          [](const PyState& s) { return nodes_copy({s.state.memory.contact}, s.state.chain.dof, s.state.model); })
      .def_prop_ro("xs",
                   [](const PyState& s) {
                     const size_t rows = size_t(s.state.options.horizon) + 1;
                     std::vector<double> xs = s.state.kept().xs;
                     const size_t columns = xs.size() / rows;
                     return array(std::move(xs), {rows, columns});
                   })
      .def_prop_ro("us",
                   [](const PyState& s) {
                     return array(s.state.kept().us, {size_t(s.state.options.horizon), size_t(s.state.chain.dof)});
                   })
      .def_prop_ro("commands",
                   [](const PyState& s) {
                     const size_t n = size_t(s.state.chain.dof), rows = s.state.series.commands.size() / n;
                     return array(s.state.series.commands, {rows, n});
                   })
      .def("copy", &copy_state)
      .def("__copy__", &copy_state)
      .def(
          "__deepcopy__", [](const PyState& s, nb::handle) { return copy_state(s); }, "memo"_a)
      .def("__getstate__",
           [](const PyState& s) {
             const std::string bytes = to_bytes(s.state);
             return nb::bytes(bytes.data(), bytes.size());
           })
      .def("__setstate__", &restore_state);

  nb::class_<PyStep>(m, "ControllerStep")
      .def("__init__", &init_step, "chain"_a, "model"_a, "nodes"_a, "phases"_a, nb::kw_only(), "frame"_a,
           "contact_frame"_a, "dt"_a, "period"_a, "tick"_a, "regularisation"_a, "bounds"_a, "max_iterations"_a,
           "tolerance"_a, "time_budget"_a.none(), "deadline"_a.none(), "riccati"_a, "interpolation"_a, "max_gap"_a,
           "fallback_damping"_a, "torque_limit"_a, "R_world_surface"_a, "stiffness_max"_a, "reference_posture"_a,
           "task_velocity"_a, "named_phases"_a, "torque_bounds"_a, "disturbance"_a, "environment"_a, "force_integral"_a,
           "force_shift_max"_a, "under_way"_a, "averaged"_a, "late"_a, "lead"_a, "environment_damping"_a = false)
      .def("init", &PyStep::init, "time"_a, "q"_a, "v"_a, "torque_sent"_a, nb::rv_policy::take_ownership)
      .def("step", &PyStep::step, "estimate"_a, "reference"_a, "state"_a, "out"_a);
}

}  // namespace pliant::mpc::binding
