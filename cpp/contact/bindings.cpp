// Python face of the contact law: pliant._contact.
#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/tuple.h>

#include <optional>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "../shared/contract.hpp"
#include "arrays.hpp"
#include "material_rows.hpp"
#include "sampled.hpp"
#include "world.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using namespace pliant;
using namespace pliant::contact;

namespace {

// f (a point → MeshPlace) of every row.
template <class F>
auto for_each_row(const Constants& points, const F& f) {
  const size_t k = rows_of_three(points, "points");
  std::vector<double> distance(k), place(3 * k), normal(3 * k);
  {
    const double* asked = points.data();
    nb::gil_scoped_release release;
    for (size_t i = 0; i < k; ++i) {
      const MeshPlace found = f(load(asked + 3 * i));
      distance[i] = found.distance;
      store(found.point, place.data() + 3 * i);
      store(found.normal, normal.data() + 3 * i);
    }
  }
  return std::make_tuple(owned(std::move(distance), {k}), owned(std::move(place), {k, 3}),
                         owned(std::move(normal), {k, 3}));
}

class TriangleMesh {
 public:
  TriangleMesh(const Constants& vertices, const Integers& triangles) : mesh_(checked(vertices, triangles)) {}

  auto nearest(const Constants& points) const {
    return for_each_row(points, [this](const Vec3& p) { return mesh_.nearest(p); });
  }

  const Mesh& mesh() const { return mesh_; }

 private:
  static Mesh checked(const Constants& vertices, const Integers& triangles) {
    const auto nv = static_cast<int32_t>(rows_of_three(vertices, "vertices"));
    if (triangles.ndim() != 2 || triangles.shape(1) != 3 || triangles.shape(0) == 0)
      throw std::invalid_argument("triangles must have shape (k, 3), k above zero");
    for (size_t i = 0; i < triangles.size(); ++i)
      if (triangles.data()[i] < 0 || triangles.data()[i] >= nv)
        throw std::invalid_argument("a triangle names a vertex that there is not");
    return Mesh(vertices.data(), nv, triangles.data(), static_cast<int>(triangles.shape(0)));
  }

  Mesh mesh_;
};

// A mesh seen through samples of its distance. Keeps a copy of them; the mesh must live as long.
class SampledMesh {
 public:
  SampledMesh(const TriangleMesh& mesh, const Constants& low, double step, const Constants& values, double band)
      : values_(values.data(), values.data() + values.size()), band_(band), mesh_(&mesh.mesh()) {
    require_size(low.size(), 3, "low");
    if (values.ndim() != 3) throw std::invalid_argument("values must have three axes");
    if (!(step > 0.0)) throw std::invalid_argument("the step must be above zero");
    field_ = {load(low.data()), step, {}, values_.data()};
    for (size_t i = 0; i < 3; ++i) field_.count[i] = static_cast<int>(values.shape(i));
  }
  SampledMesh(const SampledMesh&) = delete;
  SampledMesh& operator=(const SampledMesh&) = delete;

  auto nearest(const Constants& points) const {
    return for_each_row(points, [this](const Vec3& p) { return pliant::contact::nearest(*mesh_, field_, band_, p); });
  }

  const Form* form() const { return &form_; }

 private:
  std::vector<double> values_;
  double band_;
  const Mesh* mesh_;
  Field field_;
  Form form_{ShapeType::kField, &field_};
};

// A hole or an edge, in its own axes.
class Solid {
 public:
  explicit Solid(const Form& form) : form_(form) {}

  static Solid hole(double radius, double depth, double chamfer) {
    if (!(radius > 0.0 && chamfer >= 0.0 && depth > chamfer))
      throw std::invalid_argument("a hole needs radius > 0 and depth > chamfer >= 0");
    return Solid({ShapeType::kHole, nullptr, {radius, depth, chamfer}});
  }

  static Solid edge(double angle, double rounding) {
    if (!(angle > 0.0 && angle < 3.14 && rounding >= 0.0))
      throw std::invalid_argument("an edge needs an angle between 0 and pi and rounding >= 0");
    return Solid({ShapeType::kEdge, nullptr, {}, {angle, rounding}});
  }

  auto nearest(const Constants& points) const {
    return for_each_row(points, [this](const Vec3& p) {
      const Distance found = form_.at(p);
      return MeshPlace{found.value, p - found.value * found.gradient, found.gradient};
    });
  }

  const Form* form() const { return &form_; }

 private:
  Form form_;
};

// The contacts of one MuJoCo model and one data. Keeps the Python objects alive that own the memory it looks at.
class ContactLoop {
 public:
  ContactLoop(nb::object model, nb::object data, uintptr_t step1, uintptr_t step2)
      : model_(std::move(model)), data_(std::move(data)) {
    step1_ = reinterpret_cast<HalfStep>(step1);
    step2_ = reinterpret_cast<HalfStep>(step2);
    model_address_ = reinterpret_cast<const void*>(address(model_));
    data_address_ = reinterpret_cast<void*>(address(data_));
    views_.geom_type = array<Integers>(model_, "geom_type");
    views_.geom_body = array<Integers>(model_, "geom_bodyid");
    views_.geom_size = array<Constants>(model_, "geom_size");
    views_.body_root = array<Integers>(model_, "body_rootid");
    views_.geom_position = array<Constants>(data_, "geom_xpos");
    views_.geom_rotation = array<Constants>(data_, "geom_xmat");
    views_.body_com = array<Constants>(data_, "xipos");
    views_.subtree_com = array<Constants>(data_, "subtree_com");
    views_.body_velocity = array<Constants>(data_, "cvel");
    views_.body_force = array<Doubles>(data_, "xfrc_applied");
    views_.joint_velocity = array<Constants>(data_, "qvel");
    views_.ngeom = nb::cast<int>(model_.attr("ngeom"));
    views_.nbody = nb::cast<int>(model_.attr("nbody"));
    views_.nv = nb::cast<int>(model_.attr("nv"));
  }

  std::tuple<int, int> add_pair(int geom_a, int geom_b, const Constants& material, bool hollow, nb::object form,
                                bool tool, const std::optional<Constants>& line,
                                const std::optional<Constants>& places) {
    if (geom_a < 0 || geom_b < 0 || geom_a >= views_.ngeom || geom_b >= views_.ngeom)
      throw std::invalid_argument("a contact pair names a geom that the model does not have");
    const Graded made = graded(material, line, places);
    const Form* surface = form.is_none()                ? nullptr
                          : nb::isinstance<Solid>(form) ? nb::cast<const Solid&>(form).form()
                                                        : nb::cast<const SampledMesh&>(form).form();
    const int first = world_.add_pair(views_, geom_a, geom_b, made, hollow, surface, tool);
    if (first < 0) throw std::invalid_argument("no contact law for this pair of shapes in this order");
    forms_.push_back(std::move(form));
    return {first, world_.slots() - first};
  }

  int slots() const { return world_.slots(); }

  bool evaluate(double dt, const Constants& push, const Doubles& bristles, const Doubles& force, const Doubles& point,
                const Doubles& penetration) const {
    check(push, bristles, force, point, penetration);
    return world_.evaluate(views_, dt, push.data(), bristles.data(), {force.data(), point.data(), penetration.data()});
  }

  int advance(int count, double dt, const Constants& push, const Doubles& bristles, const Doubles& force,
              const Doubles& point, const Doubles& penetration) const {
    check(push, bristles, force, point, penetration);
    const Output out{force.data(), point.data(), penetration.data()};
    const double* push_data = push.data();
    double* bristle_data = bristles.data();
    nb::gil_scoped_release release;
    return world_.advance(views_, step1_, step2_, model_address_, data_address_, count, dt, push_data, bristle_data,
                          out);
  }

 private:
  void check(const Constants& push, const Doubles& bristles, const Doubles& force, const Doubles& point,
             const Doubles& penetration) const {
    const size_t slots = static_cast<size_t>(world_.slots());
    require_size(push.size(), 6 * static_cast<size_t>(views_.nbody), "push");
    require_size(bristles.size(), kBristleSize * slots, "bristles");
    require_size(force.size(), 3 * slots, "force");
    require_size(point.size(), 3 * slots, "point");
    require_size(penetration.size(), slots, "penetration");
  }

  nb::object model_, data_;
  std::vector<nb::object> forms_;
  Views views_{};
  World world_;
  HalfStep step1_, step2_;
  const void* model_address_;
  void* data_address_;
};

}  // namespace

NB_MODULE(_contact, m) {
  pliant::agree(m, "_contact");
  nb::set_leak_warnings(false);  // surfaces that a cache keeps until Python ends are no leak
  m.attr("BRISTLE_SIZE") = kBristleSize;
  m.attr("RIM") = kRim;
  nb::list material;
  for (const char* name : kMaterialNames) material.append(nb::str(name));
  m.attr("MATERIAL") = nb::tuple(material);
  nb::class_<TriangleMesh>(m, "TriangleMesh")
      .def(nb::init<const Constants&, const Integers&>(), "vertices"_a, "triangles"_a)
      .def("nearest", &TriangleMesh::nearest, "points"_a);
  nb::class_<SampledMesh>(m, "SampledMesh")
      .def(nb::init<const TriangleMesh&, const Constants&, double, const Constants&, double>(), nb::keep_alive<1, 2>(),
           "mesh"_a, "low"_a, "step"_a, "values"_a, "band"_a)
      .def("nearest", &SampledMesh::nearest, "points"_a);
  nb::class_<Solid>(m, "Solid")
      .def_static("hole", &Solid::hole, "radius"_a, "depth"_a, "chamfer"_a)
      .def_static("edge", &Solid::edge, "angle"_a, "rounding"_a)
      .def("nearest", &Solid::nearest, "points"_a);
  nb::class_<ContactLoop>(m, "ContactLoop")
      .def(nb::init<nb::object, nb::object, uintptr_t, uintptr_t>(), "model"_a, "data"_a, "step1"_a, "step2"_a)
      .def("add_pair", &ContactLoop::add_pair, "geom_a"_a, "geom_b"_a, "material"_a, "hollow"_a = false,
           "form"_a = nb::none(), "tool"_a = false, "line"_a = nb::none(), "places"_a = nb::none())
      .def_prop_ro("slots", &ContactLoop::slots)
      .def("evaluate", &ContactLoop::evaluate, "dt"_a, "push"_a, "bristles"_a.noconvert(), "force"_a.noconvert(),
           "point"_a.noconvert(), "penetration"_a.noconvert())
      .def("advance", &ContactLoop::advance, "count"_a, "dt"_a, "push"_a, "bristles"_a.noconvert(),
           "force"_a.noconvert(), "point"_a.noconvert(), "penetration"_a.noconvert());
}
