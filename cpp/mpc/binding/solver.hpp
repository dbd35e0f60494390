// Solver and Solution.
#pragma once
#include <nanobind/stl/optional.h>

#include "engine_handle.hpp"

namespace pliant::mpc::binding {

struct Solution {
  Report report;
  size_t N, nx, n, m;
  std::vector<double> xs, us, forces, gain;
};

struct PySolver {
  EngineHandle handle;
  nb::object nodes;
  size_t N, n, m, nx;
  double dt;

  PySolver(const PyChain& chain, const PyModel& model, const Options& o)
      : handle(chain.data, model.data, o),
        nodes(nb::cast(new PyNodes(o.horizon + 1, chain.data.dof, model.data), nb::rv_policy::take_ownership)),
        N(size_t(o.horizon)),
        n(size_t(chain.data.dof)),
        m(size_t(model.data.contact_dim)),
        nx(size_t(state_dim(model.data, chain.data.dof))),
        dt(o.dt) {}

  const NodeData* data() const {
    const PyNodes& p = nb::cast<const PyNodes&>(nodes);
    p.check(dt);
    return p.data.data();
  }
  void set_xs(nb::handle xs) const {
    std::vector<double> v((N + 1) * nx);
    read(xs, "xs", {N + 1, nx}, v.data());
    require_finite("xs", v);
    handle.table->set_plan(handle.engine, v.data(), nullptr);
  }
  void set_us(nb::handle us) const {
    std::vector<double> v(N * n);
    read(us, "us", {N, n}, v.data());
    require_finite("us", v);
    handle.table->set_plan(handle.engine, nullptr, v.data());
  }
  void quasi_static(nb::handle x0) const {
    std::vector<double> v(nx);
    read(x0, "x0", {nx}, v.data());
    handle.table->quasi_static(handle.engine, data(), v.data());
  }
  Solution solve(nb::handle x0, nb::object xs, nb::object us, int max_iterations, double tolerance,
                 std::optional<double> time_budget) const {
    if (max_iterations < 0)
      throw std::invalid_argument("max_iterations must not be negative, got " + std::to_string(max_iterations));
    if (!(tolerance > 0)) throw std::invalid_argument("tolerance must be positive, got " + std::to_string(tolerance));
    double first[3 * max_joints];
    read(x0, "x0", {nx}, first);
    if (!xs.is_none()) set_xs(xs);
    if (!us.is_none()) set_us(us);
    const NodeData* parameters = data();
    const Limits limits{max_iterations, tolerance, time_budget.value_or(-1)};
    Solution s{{}, N, nx, n, m, {}, {}, {}, {}};
    {
      const nb::gil_scoped_release released;
      handle.table->solve(handle.engine, parameters, first, limits, s.report);
    }
    s.xs.resize((N + 1) * nx);
    s.us.resize(N * n);
    s.forces.resize(N * m);
    s.gain.resize(n * nx);
    handle.table->get_plan(handle.engine, s.xs.data(), s.us.data());
    handle.table->get_feedback(handle.engine, s.gain.data(), s.forces.data());
    return s;
  }
};

inline void bind_solver(nb::module_& m) {
  nb::class_<Solution>(m, "Solution")
      .def_prop_ro("status", [](const Solution& s) { return status_names[int(s.report.status)]; })
      .def_prop_ro("xs", [](const Solution& s) { return array(s.xs, {s.N + 1, s.nx}); })
      .def_prop_ro("us", [](const Solution& s) { return array(s.us, {s.N, s.n}); })
      .def_prop_ro("forces", [](const Solution& s) { return array(s.forces, {s.N, s.m}); })
      .def_prop_ro("feedback_gain", [](const Solution& s) { return array(s.gain, {s.n, s.nx}); })
      .def_prop_ro("iterations", [](const Solution& s) { return s.report.iterations; })
      .def_prop_ro("evaluations", [](const Solution& s) { return s.report.evaluations; })
      .def_prop_ro("qp_iterations", [](const Solution& s) { return s.report.factorisations; })
      .def_prop_ro("kkt", [](const Solution& s) { return s.report.kkt; })
      .def_prop_ro("cost", [](const Solution& s) { return s.report.cost; })
      .def_prop_ro("gap", [](const Solution& s) { return s.report.gap; })
      .def_prop_ro("violation", [](const Solution& s) { return s.report.violation; })
      .def_prop_ro("solve_time", [](const Solution& s) { return s.report.seconds; });

  nb::class_<PySolver>(m, "Solver")
      .def(
          "__init__",
          [](PySolver* self, const PyChain& chain, const PyModel& model, int horizon, double dt, double regularisation,
             int filter_size, int line_search_steps, bool bounds) {
            if (horizon < 1) throw std::invalid_argument("horizon must be at least 1, got " + std::to_string(horizon));
            if (!(dt > 0)) throw std::invalid_argument("dt must be positive, got " + std::to_string(dt) + " s");
            if (!(regularisation >= 0)) throw std::invalid_argument("regularisation must not be negative");
            if (filter_size < 1 || line_search_steps < 1)
              throw std::invalid_argument("filter_size and line_search_steps must be at least 1");
            new (self) PySolver(chain, model, {horizon, dt, regularisation, filter_size, line_search_steps, bounds});
          },
          "chain"_a, "model"_a, "horizon"_a, "dt"_a, nb::kw_only(), "regularisation"_a = 1e-9, "filter_size"_a = 8,
          "line_search_steps"_a = 10, "bounds"_a = false)
      .def_prop_ro("nodes", [](const PySolver& s) { return s.nodes; })
      .def_prop_ro("horizon", [](const PySolver& s) { return s.N; })
      .def_prop_ro("dt", [](const PySolver& s) { return s.dt; })
      .def_prop_ro("nx", [](const PySolver& s) { return s.nx; })
      .def_prop_ro("nu", [](const PySolver& s) { return s.n; })
      .def_prop_rw(
          "xs",
          [](const PySolver& s) {
            std::vector<double> v((s.N + 1) * s.nx);
            s.handle.table->get_plan(s.handle.engine, v.data(), nullptr);
            return array(std::move(v), {s.N + 1, s.nx});
          },
          &PySolver::set_xs)
      .def_prop_rw(
          "us",
          [](const PySolver& s) {
            std::vector<double> v(s.N * s.n);
            s.handle.table->get_plan(s.handle.engine, nullptr, v.data());
            return array(std::move(v), {s.N, s.n});
          },
          &PySolver::set_us)
      .def("shift", [](const PySolver& s) { s.handle.table->shift(s.handle.engine); })
      .def("reset", [](const PySolver& s) { s.handle.table->reset(s.handle.engine); })
      .def("quasi_static", &PySolver::quasi_static, "x0"_a)
      .def("solve", &PySolver::solve, "x0"_a, "xs"_a = nb::none(), "us"_a = nb::none(), nb::kw_only(),
           "max_iterations"_a = 8, "tolerance"_a = 1e-4, "time_budget"_a = nb::none());
}

}  // namespace pliant::mpc::binding
