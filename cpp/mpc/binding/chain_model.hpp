// Chain and Model.
#pragma once
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <new>
#include <utility>

#include "../dispatch.hpp"
#include "../models.hpp"
#include "../validate.hpp"
#include "arrays.hpp"

namespace pliant::mpc::binding {

template <class T>
T one_of(const std::string& value, const char* what, const std::vector<std::pair<const char*, T>>& options) {
  std::string valid;
  for (const auto& [name, result] : options) {
    if (value == name) return result;
    valid += (valid.empty() ? "" : ", ") + std::string(name);
  }
  throw std::invalid_argument(std::string(what) + " must be one of " + valid + ", got '" + value + "'");
}

inline const std::vector<std::pair<const char*, Kind>> kinds = {{"force_feedback", Kind::force_feedback},
                                                                {"classical", Kind::classical},
                                                                {"torque_feedback", Kind::torque_feedback},
                                                                {"free", Kind::free},
                                                                {"naive_viscoelastic", Kind::naive_viscoelastic}};
inline const std::vector<std::pair<const char*, Axes>> axes_names = {
    {"local", Axes::local}, {"world", Axes::world}, {"surface", Axes::surface}};
inline const std::vector<std::pair<const char*, Integrator>> integrators = {{"euler", Integrator::euler},
                                                                            {"exponential", Integrator::exponential}};
inline constexpr const char* status_names[] = {"converged",   "max_iterations",        "time_budget",
                                               "line_search", "not_positive_definite", "nan"};

inline void identity(double* R) {
  for (int i = 0; i < 9; ++i) R[i] = i % 4 == 0;
}

ModelData default_model() {
  ModelData m{};
  m.kind = Kind::force_feedback;
  m.contact_dim = 1;
  m.torque_bandwidth = 50;
  return m;
}

struct PyChain {
  ChainData data{};

  nb::object mass_matrix(nb::handle q) const {
    const size_t n = size_t(data.dof);
    std::vector<double> joints(n), M(n * n);
    read(q, "q", {n}, joints.data());
    kernel(data.dof, default_model()).mass_matrix(data, joints.data(), M.data());
    return array(std::move(M), {n, n});
  }
  nb::object placement(nb::handle q, bool contact) const {
    const size_t n = size_t(data.dof);
    std::vector<double> joints(n), R(9), p(3);
    read(q, "q", {n}, joints.data());
    kernel(data.dof, default_model()).placement(data, contact, joints.data(), R.data(), p.data());
    return nb::make_tuple(array(std::move(R), {3, 3}), array(std::move(p), {3}));
  }
};

inline void init_chain(PyChain* self, nb::handle rotations, nb::handle translations,
                       const std::vector<std::string>& joint_types, nb::handle axes, nb::handle masses, nb::handle coms,
                       nb::handle inertias, nb::object rotor_inertia, nb::object joint_damping, nb::handle gravity,
                       nb::object tool_rotation, nb::object tool_translation, nb::object contact_rotation,
                       nb::object contact_translation) {
  PyChain chain;
  ChainData& d = chain.data;
  const size_t n = joint_types.size();
  if (n < 1 || n > size_t(max_joints))
    throw std::invalid_argument("a chain has 1 to " + std::to_string(max_joints) + " joints, got " + std::to_string(n));
  d.dof = int(n);
  for (size_t i = 0; i < n; ++i)
    d.prismatic[i] = one_of<bool>(joint_types[i], "joint_types", {{"revolute", false}, {"prismatic", true}});
  read(rotations, "rotations", {n, 3, 3}, d.rotation[0]);
  read(translations, "translations", {n, 3}, d.translation[0]);
  read(axes, "axes", {n, 3}, d.axis[0]);
  read(masses, "masses", {n}, d.mass);
  read(coms, "coms", {n, 3}, d.com[0]);
  read(inertias, "inertias", {n, 3, 3}, d.inertia[0]);
  if (!rotor_inertia.is_none()) read(rotor_inertia, "rotor_inertia", {n}, d.rotor_inertia);
  if (!joint_damping.is_none()) read(joint_damping, "joint_damping", {n}, d.joint_damping);
  read(gravity, "gravity", {3}, d.gravity);
  identity(d.tool_rotation);
  if (!tool_rotation.is_none()) read(tool_rotation, "tool_rotation", {3, 3}, d.tool_rotation);
  if (!tool_translation.is_none()) read(tool_translation, "tool_translation", {3}, d.tool_translation);
  std::memcpy(d.contact_rotation, d.tool_rotation, sizeof d.tool_rotation);
  std::memcpy(d.contact_translation, d.tool_translation, sizeof d.tool_translation);
  if (!contact_rotation.is_none()) read(contact_rotation, "contact_rotation", {3, 3}, d.contact_rotation);
  if (!contact_translation.is_none()) read(contact_translation, "contact_translation", {3}, d.contact_translation);
  validate(d);
  new (self) PyChain(chain);
}

struct PyModel {
  ModelData data;
};

inline void init_model(PyModel* self, const std::string& kind, int contact_dim, const std::string& axes,
                       double torque_bandwidth, std::pair<double, double> baumgarte, const std::string& integrator) {
  ModelData m = default_model();
  m.kind = one_of(kind, "kind", kinds);
  m.contact_dim = contact_dim;
  m.axes = one_of(axes, "axes", axes_names);
  m.integrator = one_of(integrator, "integrator", integrators);
  m.torque_bandwidth = torque_bandwidth;
  m.baumgarte_position = baumgarte.first;
  m.baumgarte_velocity = baumgarte.second;
  validate(m);
  new (self) PyModel{m};
}

inline void bind_chain_and_model(nb::module_& m) {
  const nb::tuple down = nb::make_tuple(0.0, 0.0, -9.81);  // [m/s²]
  nb::class_<PyChain>(m, "Chain")
      .def("__init__", &init_chain, "rotations"_a, "translations"_a, "joint_types"_a, "axes"_a, "masses"_a, "coms"_a,
           "inertias"_a, nb::kw_only(), "rotor_inertia"_a = nb::none(), "joint_damping"_a = nb::none(),
           "gravity"_a = down, "tool_rotation"_a = nb::none(), "tool_translation"_a = nb::none(),
           "contact_rotation"_a = nb::none(), "contact_translation"_a = nb::none())
      .def_prop_ro("dof", [](const PyChain& c) { return c.data.dof; })
      .def("mass_matrix", &PyChain::mass_matrix, "q"_a)
      .def(
          "contact_placement", [](const PyChain& c, nb::handle q) { return c.placement(q, true); }, "q"_a)
      .def("tool_placement", [](const PyChain& c, nb::handle q) { return c.placement(q, false); }, "q"_a);
  nb::class_<PyModel>(m, "Model")
      .def("__init__", &init_model, "kind"_a, "contact_dim"_a, "axes"_a = "world", nb::kw_only(),
           "torque_bandwidth"_a = 50.0, "baumgarte"_a = std::pair<double, double>(0.0, 0.0), "integrator"_a = "euler")
      .def_prop_ro("kind", [](const PyModel& s) { return kinds[size_t(s.data.kind)].first; })
      .def_prop_ro("contact_dim", [](const PyModel& s) { return s.data.contact_dim; })
      .def_prop_ro("axes", [](const PyModel& s) { return axes_names[size_t(s.data.axes)].first; })
      .def_prop_ro("integrator", [](const PyModel& s) { return integrators[size_t(s.data.integrator)].first; })
      .def("state_dim", [](const PyModel& s, int dof) { return state_dim(s.data, dof); }, "dof"_a);
}

}  // namespace pliant::mpc::binding
