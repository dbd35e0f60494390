#include "world.hpp"

#include <cstring>

namespace pliant::contact {
namespace {

// Anything above is a simulation that has blown up. MuJoCo has limits of its own, far higher, and writes a file when it
// meets them.
constexpr double kFastest = 1e4;    // m/s or rad/s
constexpr double kStrongest = 1e7;  // N

Shape shape_of(const Views& v, int geom, bool hollow = false, const Form* form = nullptr) {
  return {form ? form->type : static_cast<ShapeType>(v.geom_type[geom]),
          load(v.geom_size + 3 * geom),
          load(v.geom_position + 3 * geom),
          Rotation{v.geom_rotation + 9 * geom},
          hollow,
          form};
}

Vec3 point_velocity(const Views& v, int body, const Vec3& point) {
  const double* twist = v.body_velocity + 6 * body;
  const Vec3 reference = load(v.subtree_com + 3 * v.body_root[body]);
  return load(twist + 3) + cross(load(twist), point - reference);
}

void add_force(const Views& v, int body, const Vec3& point, const Vec3& force) {
  double* row = v.body_force + 6 * body;
  const Vec3 torque = cross(point - load(v.body_com + 3 * body), force);
  store(load(row) + force, row);
  store(load(row + 3) + torque, row + 3);
}

bool velocities_sound(const Views& v) {
  for (int i = 0; i < v.nv; ++i)
    if (!(std::abs(v.joint_velocity[i]) < kFastest)) return false;
  return true;
}

}  // namespace

int World::add_pair(const Views& views, int geom_a, int geom_b, const Graded& material, bool hollow, const Form* form,
                    bool tool) {
  const ShapeType a = static_cast<ShapeType>(views.geom_type[geom_a]);
  const Shape b = shape_of(views, geom_b, hollow, form);
  const int slots = tool ? tool_slots(a, b) : slot_count(a, b.type, hollow);
  if (slots == 0) return -1;
  const int first = slots_;
  pairs_.push_back({geom_a, geom_b, material, hollow, form, tool, first, slots});
  slots_ += slots;
  return first;
}

bool World::evaluate(const Views& v, double dt, const double* push, double* bristles, const Output& out) const {
  std::memcpy(v.body_force, push, sizeof(double) * 6 * static_cast<size_t>(v.nbody));
  bool sound = true;
  for (const Pair& pair : pairs_) {
    const Shape a = shape_of(v, pair.geom_a), b = shape_of(v, pair.geom_b, pair.hollow, pair.form);
    const int body_a = v.geom_body[pair.geom_a], body_b = v.geom_body[pair.geom_b];
    for (int i = 0; i < pair.slots; ++i) {
      const int slot = pair.first_slot + i;
      Bristle& bristle = *reinterpret_cast<Bristle*>(bristles + kBristleSize * slot);
      const Touch t = pair.tool ? touch_tool(a, b, i) : touch(a, b, i);
      Vec3 force{};
      if (t.penetration > 0.0) {
        const Material here = pair.material.at(t.point);
        const Material felt = pair.tool ? shared(here, share_of(a.type, b, i)) : here;
        const Vec3 velocity = point_velocity(v, body_a, t.point) - point_velocity(v, body_b, t.point);
        const double pressing = normal_force(felt, t.penetration, -dot(t.normal, velocity));
        force = pressing * t.normal + friction_force(felt, t.normal, pressing, velocity, dt, bristle);
        add_force(v, body_a, t.point, force);
        add_force(v, body_b, t.point, -force);
      } else {
        reset(bristle, pair.material.at(t.point));
      }
      sound = sound && norm(force) < kStrongest && std::isfinite(t.penetration);  // false for NaN
      store(force, out.force + 3 * slot);
      store(t.point, out.point + 3 * slot);
      out.penetration[slot] = t.penetration;
    }
  }
  return sound;
}

int World::advance(const Views& views, HalfStep step1, HalfStep step2, const void* model, void* data, int count,
                   double dt, const double* push, double* bristles, const Output& out) const {
  if (!velocities_sound(views)) return 0;
  for (int done = 0; done < count; ++done) {
    step1(model, data);
    if (!evaluate(views, dt, push, bristles, out)) return done;
    step2(model, data);
    if (!velocities_sound(views)) return done;
  }
  return count;
}

}  // namespace pliant::contact
