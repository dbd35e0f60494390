// Python face of the core; meaning, shapes and units are in src/pliant/_mpc.pyi.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <new>
#include <stdexcept>

#include "dispatch.hpp"
#include "validate.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace pliant::mpc {
namespace {

// Arrays in and out -----------------------------------------------------------------------------------------------

using Input = nb::ndarray<const double, nb::c_contig, nb::device::cpu>;

std::string shape_text(const std::vector<size_t> &shape) {
    std::string s = "(";
    for (size_t i = 0; i < shape.size(); ++i) s += (i ? ", " : "") + std::to_string(shape[i]);
    return s + (shape.size() == 1 ? ",)" : ")");
}

// Copies an array-like of the given shape into `out`.
void read(nb::handle value, const char *name, const std::vector<size_t> &shape, double *out) {
    Input a;
    if (!nb::try_cast(value, a, false)) {
        const nb::object numpy = nb::module_::import_("numpy");
        a = nb::cast<Input>(numpy.attr("ascontiguousarray")(value, "dtype"_a = "float64"));
        if (shape.empty() && a.ndim() == 1) throw std::invalid_argument(std::string(name) + " must be a number");
    }
    std::vector<size_t> got;
    for (size_t i = 0; i < a.ndim(); ++i) got.push_back(a.shape(i));
    if (got != shape)
        throw std::invalid_argument(std::string(name) + " must have shape " + shape_text(shape) + ", got " + shape_text(got));
    std::memcpy(out, a.data(), a.size() * sizeof(double));
}

using Output = nb::ndarray<nb::numpy, double>;

// A NumPy array that owns what it was filled with.
nb::object array(std::vector<double> values, std::vector<size_t> shape) {
    auto *kept = new std::vector<double>(std::move(values));
    const nb::capsule owner(kept, [](void *p) noexcept { delete static_cast<std::vector<double> *>(p); });
    return nb::cast(Output(kept->data(), shape.size(), shape.data(), owner), nb::rv_policy::reference);
}

template <class T> T one_of(const std::string &value, const char *what, const std::vector<std::pair<const char *, T>> &options) {
    std::string valid;
    for (const auto &[name, result] : options) {
        if (value == name) return result;
        valid += (valid.empty() ? "" : ", ") + std::string(name);
    }
    throw std::invalid_argument(std::string(what) + " must be one of " + valid + ", got '" + value + "'");
}

const std::vector<std::pair<const char *, Kind>> kinds = {{"force_feedback", Kind::force_feedback},
                                                          {"classical", Kind::classical},
                                                          {"torque_feedback", Kind::torque_feedback},
                                                          {"free", Kind::free},
                                                          {"naive_viscoelastic", Kind::naive_viscoelastic}};
const std::vector<std::pair<const char *, Axes>> axes_names = {
    {"local", Axes::local}, {"world", Axes::world}, {"surface", Axes::surface}};
const std::vector<std::pair<const char *, Integrator>> integrators = {{"euler", Integrator::euler},
                                                                      {"exponential", Integrator::exponential}};
constexpr const char *status_names[] = {"converged",   "max_iterations",        "time_budget",
                                        "line_search", "not_positive_definite", "nan"};

void identity(double *R) {
    for (int i = 0; i < 9; ++i) R[i] = i % 4 == 0;
}

// Chain and model -------------------------------------------------------------------------------------------------

ModelData default_model() {
    ModelData m{};
    m.kind = Kind::force_feedback;
    m.contact_dim = 1;
    m.torque_bandwidth = 50;
    identity(m.surface_rotation);
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

void init_chain(PyChain *self, nb::handle rotations, nb::handle translations, const std::vector<std::string> &joint_types,
                nb::handle axes, nb::handle masses, nb::handle coms, nb::handle inertias, nb::object rotor_inertia,
                nb::object joint_damping, nb::handle gravity, nb::object tool_rotation, nb::object tool_translation,
                nb::object contact_rotation, nb::object contact_translation) {
    PyChain chain;
    ChainData &d = chain.data;
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

void init_model(PyModel *self, const std::string &kind, int contact_dim, const std::string &axes,
                nb::object surface_rotation, double torque_bandwidth, std::pair<double, double> baumgarte,
                const std::string &integrator) {
    ModelData m = default_model();
    m.kind = one_of(kind, "kind", kinds);
    m.contact_dim = contact_dim;
    m.axes = one_of(axes, "axes", axes_names);
    m.integrator = one_of(integrator, "integrator", integrators);
    m.torque_bandwidth = torque_bandwidth;
    m.baumgarte_position = baumgarte.first;
    m.baumgarte_velocity = baumgarte.second;
    if ((m.axes == Axes::surface) == surface_rotation.is_none())
        throw std::invalid_argument("surface_rotation goes with axes 'surface' and with no other, got axes '" + axes + "'");
    if (!surface_rotation.is_none()) read(surface_rotation, "surface_rotation", {3, 3}, m.surface_rotation);
    validate(m);
    new (self) PyModel{m};
}

int state_dim(const ModelData &m, int dof) {
    return 2 * dof + (m.kind == Kind::force_feedback ? m.contact_dim : m.kind == Kind::torque_feedback ? dof : 0);
}

// Node parameters -------------------------------------------------------------------------------------------------

struct PyNodes {
    std::vector<NodeData> data;
    int dof;
    ModelData model;

    PyNodes(int count, int n, const ModelData &m) : data(size_t(count)), dof(n), model(m) {
        const double inf = std::numeric_limits<double>::infinity();
        for (NodeData &d : data) {
            d = NodeData{};
            identity(d.rotation_reference);
            identity(d.anchor_rotation);
            for (int i = 0; i < max_joints; ++i) {
                d.torque_lower[i] = -inf;
                d.torque_upper[i] = inf;
            }
            for (int i = 0; i < max_contact; ++i) {
                d.stiffness[i] = 1e3; // [N/m]
                d.damping[i] = 1e2;   // [N·s/m]
                d.force_lower[i] = -inf;
                d.force_upper[i] = inf;
            }
            d.friction = inf;
            d.contact_active = m.contact_dim > 0;
        }
    }
    void check() const {
        for (size_t k = 0; k < data.size(); ++k) validate(data[k], int(k), dof, model);
    }
    void copy_node(int source, int target) {
        const int count = int(data.size());
        if (source < 0 || source >= count || target < 0 || target >= count)
            throw std::invalid_argument("copy_node takes nodes 0 to " + std::to_string(count - 1) + ", got " +
                                        std::to_string(source) + " and " + std::to_string(target));
        data[size_t(target)] = data[size_t(source)];
    }
};

// A writable view of one field of all nodes.
template <class T> nb::object field_view(nb::handle self, T *first, std::vector<size_t> inner) {
    PyNodes &nodes = nb::cast<PyNodes &>(self);
    std::vector<size_t> shape = {nodes.data.size()};
    std::vector<int64_t> strides = {int64_t(sizeof(NodeData) / sizeof(T))};
    int64_t stride = 1;
    for (size_t s : inner) {
        shape.push_back(s);
        stride *= int64_t(s);
    }
    for (size_t s : inner) {
        stride /= int64_t(s > 0 ? s : 1);
        strides.push_back(stride);
    }
    using View = nb::ndarray<nb::numpy, T>;
    return nb::cast(View(first, shape.size(), shape.data(), self, strides.data()), nb::rv_policy::reference);
}

using Shape = std::vector<size_t> (*)(const PyNodes &);

template <class View> void def_field(nb::class_<PyNodes> &c, const char *name, View view) {
    c.def_prop_rw(
        name, [view](nb::handle self) { return view(self); },
        [view](nb::handle self, nb::object value) { view(self)[nb::ellipsis()] = value; });
}

template <class Member> void def_array(nb::class_<PyNodes> &c, const char *name, Member member, Shape shape) {
    def_field(c, name, [member, shape](nb::handle self) {
        PyNodes &nodes = nb::cast<PyNodes &>(self);
        return field_view<double>(self, (nodes.data[0].*member), shape(nodes));
    });
}

void bind_nodes(nb::module_ &m) {
    const Shape joints = [](const PyNodes &n) { return std::vector<size_t>{size_t(n.dof)}; };
    const Shape state = [](const PyNodes &n) { return std::vector<size_t>{size_t(2 * n.dof)}; };
    const Shape contact = [](const PyNodes &n) { return std::vector<size_t>{size_t(n.model.contact_dim)}; };
    const Shape three = [](const PyNodes &) { return std::vector<size_t>{3}; };
    const Shape six = [](const PyNodes &) { return std::vector<size_t>{6}; };
    const Shape rotation = [](const PyNodes &) { return std::vector<size_t>{3, 3}; };
    nb::class_<PyNodes> c(m, "Nodes");
    def_array(c, "state_reference", &NodeData::state_reference, state);
    def_array(c, "state_weight", &NodeData::state_weight, state);
    def_array(c, "control_reference", &NodeData::control_reference, joints);
    def_array(c, "control_weight", &NodeData::control_weight, joints);
    def_array(c, "torque_gravity_weight", &NodeData::torque_gravity_weight, joints);
    def_array(c, "control_gravity_weight", &NodeData::control_gravity_weight, joints);
    def_array(c, "translation_reference", &NodeData::translation_reference, three);
    def_array(c, "translation_weight", &NodeData::translation_weight, three);
    def_array(c, "rotation_reference", &NodeData::rotation_reference, rotation);
    def_array(c, "rotation_weight", &NodeData::rotation_weight, three);
    def_array(c, "velocity_reference", &NodeData::velocity_reference, six);
    def_array(c, "velocity_weight", &NodeData::velocity_weight, six);
    def_array(c, "force_reference", &NodeData::force_reference, contact);
    def_array(c, "force_weight", &NodeData::force_weight, contact);
    def_array(c, "force_rate_weight", &NodeData::force_rate_weight, contact);
    def_array(c, "stiffness", &NodeData::stiffness, contact);
    def_array(c, "damping", &NodeData::damping, contact);
    def_array(c, "anchor_translation", &NodeData::anchor_translation, three);
    def_array(c, "anchor_rotation", &NodeData::anchor_rotation, rotation);
    def_array(c, "torque_lower", &NodeData::torque_lower, joints);
    def_array(c, "torque_upper", &NodeData::torque_upper, joints);
    def_array(c, "force_lower", &NodeData::force_lower, contact);
    def_array(c, "force_upper", &NodeData::force_upper, contact);
    def_field(c, "friction", [](nb::handle self) {
        return field_view<double>(self, &nb::cast<PyNodes &>(self).data[0].friction, {});
    });
    def_field(c, "contact_active", [](nb::handle self) {
        return field_view<bool>(self, &nb::cast<PyNodes &>(self).data[0].contact_active, {});
    });
    c.def_prop_ro("count", [](const PyNodes &n) { return n.data.size(); });
    c.def("copy_node", &PyNodes::copy_node, "source"_a, "target"_a);
}

// Engine ----------------------------------------------------------------------------------------------------------

// Owns an engine of the instruction set chosen when it was made.
class EngineHandle {
  public:
    EngineHandle(const ChainData &chain, const ModelData &model, const Options &options)
        : table(&kernel(chain.dof, model)), engine(table->create(chain, model, options)) {
        if (!engine) throw std::bad_alloc();
    }
    EngineHandle(const EngineHandle &) = delete;
    EngineHandle &operator=(const EngineHandle &) = delete;
    ~EngineHandle() { table->destroy(engine); }

    const KernelTable *table;
    Engine *engine;
};

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
    bool terminal;

    static Options options(double dt) { return {1, dt, 0, 1, 1, false}; }
    PyNode(const PyChain &chain, const PyModel &model, double dt, bool terminal_)
        : handle(chain.data, model.data, options(dt)),
          nodes(nb::cast(new PyNodes(1, chain.data.dof, model.data), nb::rv_policy::take_ownership)),
          n(size_t(chain.data.dof)), m(size_t(model.data.contact_dim)), nx(size_t(state_dim(model.data, chain.data.dof))),
          terminal(terminal_) {}

    const NodeData &data() const {
        const PyNodes &p = nb::cast<const PyNodes &>(nodes);
        p.check();
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
        NodeOutput out{unset,         r.x_next.data(), r.acceleration.data(), r.force.data(), r.force_rate.data(),
                       r.fx.data(),   r.fu.data(),     r.Lx.data(),           r.Lu.data(),    r.Lxx.data(),
                       r.Lxu.data(),  r.Luu.data(),    r.force_x.data(),      r.force_u.data()};
        handle.table->node(handle.engine, data(), terminal, derivatives, state.data(), control.data(), out);
        r.cost = out.cost;
        return r;
    }
    void freeze(nb::handle q) const {
        std::vector<double> joints(n);
        read(q, "q", {n}, joints.data());
        handle.table->freeze(handle.engine, joints.data());
    }
    double benchmark(nb::handle x, nb::handle u, int repetitions, bool derivatives) const {
        std::vector<double> state(nx), control(n);
        read(x, "x", {nx}, state.data());
        read(u, "u", {n}, control.data());
        return handle.table->time_node(handle.engine, data(), terminal, derivatives, state.data(), control.data(), repetitions);
    }
};

using Values = std::vector<double> NodeResult::*;

void bind_node(nb::module_ &m) {
    nb::class_<NodeResult> r(m, "NodeResult");
    r.def_ro("cost", &NodeResult::cost);
    const auto vector = [&r](const char *name, Values values) {
        r.def_prop_ro(name, [values](const NodeResult &s) { return array(s.*values, {(s.*values).size()}); });
    };
    vector("x_next", &NodeResult::x_next);
    vector("acceleration", &NodeResult::acceleration);
    vector("force", &NodeResult::force);
    vector("force_rate", &NodeResult::force_rate);
    const auto derivative = [&r](const char *name, Values values, size_t NodeResult::*rows, size_t NodeResult::*columns) {
        r.def_prop_ro(name, [=](const NodeResult &s) -> nb::object {
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
            [](PyNode *self, const PyChain &chain, const PyModel &model, double dt, bool terminal) {
                if (!(dt > 0)) throw std::invalid_argument("dt must be positive, got " + std::to_string(dt) + " s");
                new (self) PyNode(chain, model, dt, terminal);
            },
            "chain"_a, "model"_a, "dt"_a, nb::kw_only(), "terminal"_a = false)
        .def_prop_ro("parameters", [](const PyNode &s) { return s.nodes; })
        .def_prop_ro("nx", [](const PyNode &s) { return s.nx; })
        .def("freeze", &PyNode::freeze, "q"_a)
        .def("calc", [](const PyNode &s, nb::handle x, nb::handle u) { return s.evaluate(x, u, false); }, "x"_a, "u"_a)
        .def("calc_diff", [](const PyNode &s, nb::handle x, nb::handle u) { return s.evaluate(x, u, true); }, "x"_a, "u"_a)
        .def("benchmark", &PyNode::benchmark, "x"_a, "u"_a, "repetitions"_a, nb::kw_only(), "derivatives"_a = true);
}

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

    PySolver(const PyChain &chain, const PyModel &model, const Options &o)
        : handle(chain.data, model.data, o),
          nodes(nb::cast(new PyNodes(o.horizon + 1, chain.data.dof, model.data), nb::rv_policy::take_ownership)),
          N(size_t(o.horizon)), n(size_t(chain.data.dof)), m(size_t(model.data.contact_dim)),
          nx(size_t(state_dim(model.data, chain.data.dof))), dt(o.dt) {}

    const NodeData *data() const {
        const PyNodes &p = nb::cast<const PyNodes &>(nodes);
        p.check();
        return p.data.data();
    }
    void set_xs(nb::handle xs) const {
        std::vector<double> v((N + 1) * nx);
        read(xs, "xs", {N + 1, nx}, v.data());
        handle.table->set_plan(handle.engine, v.data(), nullptr);
    }
    void set_us(nb::handle us) const {
        std::vector<double> v(N * n);
        read(us, "us", {N, n}, v.data());
        handle.table->set_plan(handle.engine, nullptr, v.data());
    }
    void quasi_static(nb::handle x0) const {
        std::vector<double> v(nx);
        read(x0, "x0", {nx}, v.data());
        handle.table->quasi_static(handle.engine, data(), v.data());
    }
    Solution solve(nb::handle x0, nb::object xs, nb::object us, int max_iterations, double tolerance,
                   std::optional<double> time_budget) const {
        if (max_iterations < 0) throw std::invalid_argument("max_iterations must not be negative, got " + std::to_string(max_iterations));
        if (!(tolerance > 0)) throw std::invalid_argument("tolerance must be positive, got " + std::to_string(tolerance));
        double first[3 * max_joints];
        read(x0, "x0", {nx}, first);
        if (!xs.is_none()) set_xs(xs);
        if (!us.is_none()) set_us(us);
        const NodeData *parameters = data();
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

void bind_solver(nb::module_ &m) {
    nb::class_<Solution>(m, "Solution")
        .def_prop_ro("status", [](const Solution &s) { return status_names[int(s.report.status)]; })
        .def_prop_ro("xs", [](const Solution &s) { return array(s.xs, {s.N + 1, s.nx}); })
        .def_prop_ro("us", [](const Solution &s) { return array(s.us, {s.N, s.n}); })
        .def_prop_ro("forces", [](const Solution &s) { return array(s.forces, {s.N, s.m}); })
        .def_prop_ro("feedback_gain", [](const Solution &s) { return array(s.gain, {s.n, s.nx}); })
        .def_prop_ro("iterations", [](const Solution &s) { return s.report.iterations; })
        .def_prop_ro("evaluations", [](const Solution &s) { return s.report.evaluations; })
        .def_prop_ro("qp_iterations", [](const Solution &s) { return s.report.factorisations; })
        .def_prop_ro("kkt", [](const Solution &s) { return s.report.kkt; })
        .def_prop_ro("cost", [](const Solution &s) { return s.report.cost; })
        .def_prop_ro("gap", [](const Solution &s) { return s.report.gap; })
        .def_prop_ro("violation", [](const Solution &s) { return s.report.violation; })
        .def_prop_ro("solve_time", [](const Solution &s) { return s.report.seconds; });

    nb::class_<PySolver>(m, "Solver")
        .def(
            "__init__",
            [](PySolver *self, const PyChain &chain, const PyModel &model, int horizon, double dt, double regularisation,
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
        .def_prop_ro("nodes", [](const PySolver &s) { return s.nodes; })
        .def_prop_ro("horizon", [](const PySolver &s) { return s.N; })
        .def_prop_ro("dt", [](const PySolver &s) { return s.dt; })
        .def_prop_ro("nx", [](const PySolver &s) { return s.nx; })
        .def_prop_ro("nu", [](const PySolver &s) { return s.n; })
        .def_prop_rw(
            "xs",
            [](const PySolver &s) {
                std::vector<double> v((s.N + 1) * s.nx);
                s.handle.table->get_plan(s.handle.engine, v.data(), nullptr);
                return array(std::move(v), {s.N + 1, s.nx});
            },
            &PySolver::set_xs)
        .def_prop_rw(
            "us",
            [](const PySolver &s) {
                std::vector<double> v(s.N * s.n);
                s.handle.table->get_plan(s.handle.engine, nullptr, v.data());
                return array(std::move(v), {s.N, s.n});
            },
            &PySolver::set_us)
        .def("shift", [](const PySolver &s) { s.handle.table->shift(s.handle.engine); })
        .def("reset", [](const PySolver &s) { s.handle.table->reset(s.handle.engine); })
        .def("quasi_static", &PySolver::quasi_static, "x0"_a)
        .def("solve", &PySolver::solve, "x0"_a, "xs"_a = nb::none(), "us"_a = nb::none(), nb::kw_only(),
             "max_iterations"_a = 8, "tolerance"_a = 1e-4, "time_budget"_a = nb::none());
}

} // namespace

NB_MODULE(_mpc, m) {
    m.attr("MAX_JOINTS") = max_joints;
    const nb::tuple down = nb::make_tuple(0.0, 0.0, -9.81); // [m/s²]
    nb::class_<PyChain>(m, "Chain")
        .def("__init__", &init_chain, "rotations"_a, "translations"_a, "joint_types"_a, "axes"_a, "masses"_a, "coms"_a,
             "inertias"_a, nb::kw_only(), "rotor_inertia"_a = nb::none(), "joint_damping"_a = nb::none(), "gravity"_a = down,
             "tool_rotation"_a = nb::none(), "tool_translation"_a = nb::none(), "contact_rotation"_a = nb::none(),
             "contact_translation"_a = nb::none())
        .def_prop_ro("dof", [](const PyChain &c) { return c.data.dof; })
        .def("mass_matrix", &PyChain::mass_matrix, "q"_a)
        .def("contact_placement", [](const PyChain &c, nb::handle q) { return c.placement(q, true); }, "q"_a)
        .def("tool_placement", [](const PyChain &c, nb::handle q) { return c.placement(q, false); }, "q"_a);
    nb::class_<PyModel>(m, "Model")
        .def("__init__", &init_model, "kind"_a, "contact_dim"_a, "axes"_a = "world", nb::kw_only(),
             "surface_rotation"_a = nb::none(), "torque_bandwidth"_a = 50.0,
             "baumgarte"_a = std::pair<double, double>(0.0, 0.0), "integrator"_a = "euler")
        .def_prop_ro("kind", [](const PyModel &s) { return kinds[size_t(s.data.kind)].first; })
        .def_prop_ro("contact_dim", [](const PyModel &s) { return s.data.contact_dim; })
        .def_prop_ro("axes", [](const PyModel &s) { return axes_names[size_t(s.data.axes)].first; })
        .def_prop_ro("integrator", [](const PyModel &s) { return integrators[size_t(s.data.integrator)].first; })
        .def("state_dim", [](const PyModel &s, int dof) { return state_dim(s.data, dof); }, "dof"_a);
    bind_nodes(m);
    bind_node(m);
    bind_solver(m);
    m.def("instruction_set", &instruction_set);
    m.def("available_instruction_sets", &available_instruction_sets);
    m.def("use_instruction_set", &use_instruction_set, "name"_a);
}

} // namespace pliant::mpc
