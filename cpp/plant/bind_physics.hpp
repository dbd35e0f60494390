// Python face of a simulated robot in MuJoCo. Arrays are checked here; what is inside trusts them.
#pragma once
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "../shared/numpy_arrays.hpp"
#include "physics.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace pliant::plant {

using Vector = Packed<double>;
using ConstVector = Packed<const double>;
using Doubles = std::vector<double>;
using PushRow = std::tuple<int, Doubles, double, double>;                       // site, N, s, s
using SensorRow = std::tuple<int, double, Doubles, Doubles, std::vector<int>>;  // see Sensor

inline void expect(size_t got, int wanted, const char* name) {
  if (got != size_t(wanted))
    throw std::invalid_argument(std::string(name) + " must have " + std::to_string(wanted) + " entries, got " +
                                std::to_string(got));
}

template <class To>
To* pointed(const nb::handle& owner) {
  return reinterpret_cast<To*>(nb::cast<uintptr_t>(owner.attr("_address")));
}

template <class Array>
auto address_of(const nb::handle& owner, const char* name) {
  return nb::cast<Array>(owner.attr(name)).data();
}

inline std::vector<Push> pushes_of(const std::vector<PushRow>& rows) {
  std::vector<Push> found;
  for (const auto& [site, force, start, stop] : rows) {
    expect(force.size(), 3, "a push's force");
    found.push_back({site, {force[0], force[1], force[2]}, start, stop});
  }
  return found;
}

inline Library library_of(const std::vector<uintptr_t>& at) {
  expect(at.size(), 7, "functions");
  return {reinterpret_cast<decltype(&mj_step1)>(at[0]),
          reinterpret_cast<decltype(&mj_step2)>(at[1]),
          reinterpret_cast<decltype(&mj_contactForce)>(at[2]),
          reinterpret_cast<decltype(&mj_applyFT)>(at[3]),
          reinterpret_cast<decltype(&mj_rnePostConstraint)>(at[4]),
          reinterpret_cast<decltype(&mj_objectAcceleration)>(at[5]),
          reinterpret_cast<decltype(&mj_objectVelocity)>(at[6])};
}

// Whether the headers that this was compiled with lay model and data out as the library does.
inline bool same_layout(nb::handle model, nb::handle data) {
  const auto* m = pointed<const mjModel>(model);
  const auto* d = pointed<const mjData>(data);
  using Integers = nb::ndarray<const int32_t, nb::device::cpu>;
  using Numbers = nb::ndarray<const double, nb::device::cpu>;
  const int ncon = nb::cast<int>(data.attr("ncon"));
  bool same = m->nv == nb::cast<int>(model.attr("nv")) && m->ngeom == nb::cast<int>(model.attr("ngeom")) &&
              m->site_bodyid == address_of<Integers>(model, "site_bodyid") && d->ncon == ncon &&
              d->time == nb::cast<double>(data.attr("time"));
  for (const auto& [name, at] :
       {std::pair{"qpos", d->qpos}, std::pair{"qvel", d->qvel}, std::pair{"qfrc_applied", d->qfrc_applied},
        std::pair{"qfrc_bias", d->qfrc_bias}, std::pair{"site_xpos", d->site_xpos},
        std::pair{"site_xmat", d->site_xmat}, std::pair{"xpos", d->xpos}, std::pair{"xquat", d->xquat}})
    same = same && at == address_of<Numbers>(data, name);
  const nb::object contacts = data.attr("contact");
  for (int k = 0; same && k < ncon; ++k) {
    const nb::object contact = contacts[nb::int_(k)];
    same = d->contact[k].pos == address_of<Numbers>(contact, "pos") &&
           d->contact[k].frame == address_of<Numbers>(contact, "frame") &&
           d->contact[k].geom == address_of<Integers>(contact, "geom");
  }
  return same;
}

// A simulated robot. Keeps the model alive that it looks at.
class PyPhysics {
 public:
  PyPhysics(nb::object model, const std::vector<uintptr_t>& functions, int substeps, bool coriolis, Doubles limit,
            Doubles fastest, std::vector<int> frame_of_geom, std::vector<int> frame_site,
            std::vector<int> frame_of_slot, const std::vector<SensorRow>& sensors, const std::vector<PushRow>& pushes)
      : model_(std::move(model)),
        physics_(world_of(pointed<const mjModel>(model_), substeps, coriolis, std::move(limit), std::move(fastest),
                          std::move(frame_of_geom), std::move(frame_site), std::move(frame_of_slot), sensors),
                 library_of(functions), pointed<const mjModel>(model_)),
        pushes_(pushes_of(pushes)) {}

  // Joint speeds allowed: a mask of the frames that touch; else -1.
  int64_t step(nb::handle data, const ConstVector& torque, const std::vector<PushRow>& more, const Vector& out) const {
    expect(torque.size(), physics_.world().n, "torque");
    expect(out.size(), physics_.outcome_size(), "out");
    const std::vector<Push> pushes = all_pushes(more);
    auto* d = pointed<mjData>(data);
    std::uint64_t touching = 0;
    const double* asked = torque.data();
    const Outcome outcome = physics_.outcome(out.data());
    nb::gil_scoped_release release;
    return physics_.step(d, asked, pushes, outcome, touching) ? static_cast<int64_t>(touching) : -1;
  }

  // The same for a period whose steps are made elsewhere, before and after them.
  void hold(nb::handle data, const ConstVector& torque, const std::vector<PushRow>& more, const Vector& out) const {
    expect(torque.size(), physics_.world().n, "torque");
    expect(out.size(), physics_.outcome_size(), "out");
    physics_.hold(pointed<mjData>(data), torque.data(), all_pushes(more), physics_.outcome(out.data()));
  }
  int64_t read(nb::handle data, const ConstVector& force, const ConstVector& point, const Vector& out) const {
    const int numbers = 3 * int(physics_.world().frame_of_slot.size());
    expect(force.size(), numbers, "force");
    expect(point.size(), numbers, "point");
    expect(out.size(), physics_.outcome_size(), "out");
    std::uint64_t touching = 0;
    const Outcome outcome = physics_.outcome(out.data());
    const bool allowed = physics_.read(pointed<mjData>(data), {force.data(), point.data()}, outcome, touching);
    return allowed ? static_cast<int64_t>(touching) : -1;
  }

  std::vector<Push> all_pushes(const std::vector<PushRow>& more) const {
    std::vector<Push> pushes = pushes_;
    for (const Push& push : pushes_of(more)) pushes.push_back(push);
    return pushes;
  }
  const Physics& physics() const { return physics_; }

 private:
  static World world_of(const mjModel* model, int substeps, bool coriolis, Doubles limit, Doubles fastest,
                        std::vector<int> frame_of_geom, std::vector<int> frame_site, std::vector<int> frame_of_slot,
                        const std::vector<SensorRow>& sensors) {
    World world;
    world.n = int(limit.size());
    world.substeps = substeps;
    world.coriolis = coriolis;
    expect(fastest.size(), world.n, "fastest");
    expect(frame_of_geom.size(), model->ngeom, "frame_of_geom");
    if (world.n > model->nv) throw std::invalid_argument("the model has fewer joints than the robot");
    world.limit = std::move(limit);
    world.fastest = std::move(fastest);
    world.frame_of_geom = std::move(frame_of_geom);
    world.frame_site = std::move(frame_site);
    for (const int frame : frame_of_slot)
      if (frame >= int(world.frame_site.size()))
        throw std::invalid_argument("frame_of_slot names a frame that is none");
    world.frame_of_slot = std::move(frame_of_slot);
    for (const auto& [site, mass, center, inertia, felt] : sensors) {
      expect(center.size(), 3, "center");
      expect(inertia.size(), 9, "inertia");
      Sensor made{site, mass, {}, {}, felt};
      std::copy(center.begin(), center.end(), made.center);
      std::copy(inertia.begin(), inertia.end(), made.inertia);
      world.sensors.push_back(std::move(made));
    }
    return world;
  }

  nb::object model_;
  Physics physics_;
  std::vector<Push> pushes_;
};

}  // namespace pliant::plant
