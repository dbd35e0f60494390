// Node: one node by itself.
#pragma once
#include "engine_handle.hpp"

namespace pliant::mpc::binding {

struct NodeResult {
  size_t nx, n, m;
  bool derivatives;
  double cost;
  std::vector<double> x_next, acceleration, force, force_rate, fx, fu, Lx, Lu, Lxx, Lxu, Luu, force_x, force_u;
};

struct PyNode {
  EngineHandle handle;
  nb::object nodes;
  size_t n, m, nx;
  double dt;
  bool terminal;

  static Options options(double dt) { return {1, dt, 0, 1, 1, false}; }
  PyNode(const PyChain& chain, const PyModel& model, double step, bool terminal_)
      : handle(chain.data, model.data, options(step)),
        nodes(nb::cast(new PyNodes(1, chain.data.dof, model.data), nb::rv_policy::take_ownership)),
        n(size_t(chain.data.dof)),
        m(size_t(model.data.contact_dim)),
        nx(size_t(state_dim(model.data, chain.data.dof))),
        dt(step),
        terminal(terminal_) {}

  const NodeData& data() const {
    const PyNodes& p = nb::cast<const PyNodes&>(nodes);
    p.check(dt);
    return p.data[0];
  }
  NodeResult evaluate(nb::handle x, nb::handle u, bool derivatives) const {
    std::vector<double> state(nx), control(n);
    read(x, "x", {nx}, state.data());
    read(u, "u", {n}, control.data());
    const double unset = std::numeric_limits<double>::quiet_NaN();
    NodeResult r{nx, n, m, derivatives, unset, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}};
    r.x_next.assign(nx, unset);
    r.acceleration.assign(n, 0);
    r.force.assign(m, 0);
    r.force_rate.assign(m, 0);
    r.fx.assign(nx * nx, terminal ? 0 : unset);
    r.fu.assign(nx * n, terminal ? 0 : unset);
    r.Lx.assign(nx, unset);
    r.Lu.assign(n, unset);
    r.Lxx.assign(nx * nx, unset);
    r.Lxu.assign(nx * n, unset);
    r.Luu.assign(n * n, unset);
    r.force_x.assign(m * nx, terminal ? 0 : unset);
    r.force_u.assign(m * n, terminal ? 0 : unset);
    NodeOutput out{unset,        r.x_next.data(), r.acceleration.data(), r.force.data(),  r.force_rate.data(),
                   r.fx.data(),  r.fu.data(),     r.Lx.data(),           r.Lu.data(),     r.Lxx.data(),
                   r.Lxu.data(), r.Luu.data(),    r.force_x.data(),      r.force_u.data()};
    handle.table->node(handle.engine, data(), terminal, derivatives, state.data(), control.data(), out);
    r.cost = out.cost;
    return r;
  }
  void freeze(nb::handle q) const {
    std::vector<double> joints(n);
    read(q, "q", {n}, joints.data());
    handle.table->freeze(handle.engine, data().task_rotation, joints.data());
  }
  double benchmark(nb::handle x, nb::handle u, int repetitions, bool derivatives) const {
    std::vector<double> state(nx), control(n);
    read(x, "x", {nx}, state.data());
    read(u, "u", {n}, control.data());
    return handle.table->time_node(handle.engine, data(), terminal, derivatives, state.data(), control.data(),
                                   repetitions);
  }
};

using Values = std::vector<double> NodeResult::*;

inline void bind_node(nb::module_& m) {
  nb::class_<NodeResult> r(m, "NodeResult");
  r.def_ro("cost", &NodeResult::cost);
  const auto vector = [&r](const char* name, Values values) {
    r.def_prop_ro(name, [values](const NodeResult& s) { return array(s.*values, {(s.*values).size()}); });
  };
  vector("x_next", &NodeResult::x_next);
  vector("acceleration", &NodeResult::acceleration);
  vector("force", &NodeResult::force);
  vector("force_rate", &NodeResult::force_rate);
  const auto derivative = [&r](const char* name, Values values, size_t NodeResult::* rows,
                               size_t NodeResult::* columns) {
    r.def_prop_ro(name, [=](const NodeResult& s) -> nb::object {
      if (!s.derivatives) return nb::none();
      if (!columns) return array(s.*values, {s.*rows});
      return array(s.*values, {s.*rows, s.*columns});
    });
  };
  derivative("fx", &NodeResult::fx, &NodeResult::nx, &NodeResult::nx);
  derivative("fu", &NodeResult::fu, &NodeResult::nx, &NodeResult::n);
  derivative("Lx", &NodeResult::Lx, &NodeResult::nx, nullptr);
  derivative("Lu", &NodeResult::Lu, &NodeResult::n, nullptr);
  derivative("Lxx", &NodeResult::Lxx, &NodeResult::nx, &NodeResult::nx);
  derivative("Lxu", &NodeResult::Lxu, &NodeResult::nx, &NodeResult::n);
  derivative("Luu", &NodeResult::Luu, &NodeResult::n, &NodeResult::n);
  derivative("force_x", &NodeResult::force_x, &NodeResult::m, &NodeResult::nx);
  derivative("force_u", &NodeResult::force_u, &NodeResult::m, &NodeResult::n);

  nb::class_<PyNode>(m, "Node")
      .def(
          "__init__",
          [](PyNode* self, const PyChain& chain, const PyModel& model, double dt, bool terminal) {
            if (!(dt > 0)) throw std::invalid_argument("dt must be positive, got " + std::to_string(dt) + " s");
            new (self) PyNode(chain, model, dt, terminal);
          },
          "chain"_a, "model"_a, "dt"_a, nb::kw_only(), "terminal"_a = false)
      .def_prop_ro("parameters", [](const PyNode& s) { return s.nodes; })
      .def_prop_ro("nx", [](const PyNode& s) { return s.nx; })
      .def("freeze", &PyNode::freeze, "q"_a)
      .def(
          "calc", [](const PyNode& s, nb::handle x, nb::handle u) { return s.evaluate(x, u, false); }, "x"_a, "u"_a)
      .def(
          "calc_diff", [](const PyNode& s, nb::handle x, nb::handle u) { return s.evaluate(x, u, true); }, "x"_a, "u"_a)
      .def("benchmark", &PyNode::benchmark, "x"_a, "u"_a, "repetitions"_a, nb::kw_only(), "derivatives"_a = true);
}

}  // namespace pliant::mpc::binding
