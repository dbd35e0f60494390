// Where two primitive shapes touch. Shapes are MuJoCo geoms: same types, sizes and local axes.
#pragma once

#include "field.hpp"
#include "solids.hpp"
#include "../shared/vec3.hpp"

namespace pliant::contact {

// mjtGeom's values, and some of our own: a part whose surface is a sampled distance, a hole and an edge.
enum class ShapeType : int {
  kPlane = 0,
  kSphere = 2,
  kCapsule = 3,
  kCylinder = 5,
  kBox = 6,
  kField = 1000,
  kHole = 1001,
  kEdge = 1002
};

// What takes the place of B's own shape, in its axes: samples of a distance, or a solid in closed form.
struct Form {
  ShapeType type;                // kField, kHole or kEdge
  const Field* field = nullptr;  // of kField
  Hole hole{};                   // of kHole
  Edge edge{};                   // of kEdge

  Distance at(const Vec3& point) const {
    if (type == ShapeType::kHole) return distance_to(hole, point);
    return type == ShapeType::kEdge ? distance_to(edge, point) : field->at(point);
  }
};

struct Shape {
  ShapeType type;
  Vec3 size;  // sphere, cylinder: radius; capsule: radius, half length along local z; box: half extents; plane: unused
  Vec3 position;               // m, world
  Rotation rotation;           // R_world_shape
  bool hollow;                 // of B, a sphere or cylinder: the material is outside of it
  const Form* form = nullptr;  // of B: what takes its own shape's place
};

struct Touch {
  Vec3 point;          // m, world, halfway between the two surfaces
  Vec3 normal;         // unit, from B towards A
  double penetration;  // m, above zero where the shapes overlap
};

// What A presents to B: a centre and a radius (zero for a corner or a point of a rim).
struct Ball {
  Vec3 centre;
  double radius;
};

// How many contact points a pair can have; 0 where the pair is not supported. A is a sphere, capsule or box, B a plane,
// box, sphere, cylinder without ends, field, hole or edge. On a plane, a field, a hole, an edge and in a hollow B a box
// acts through its eight corners, a capsule through its two ends; a box does not act on a round B from outside. For A a
// tool see tool.hpp.
int slot_count(ShapeType a, ShapeType b, bool hollow);

// The contact point number `slot` of a pair.
Touch touch(const Shape& a, const Shape& b, int slot);

// Where a ball touches B.
Touch touch_ball(const Ball& ball, const Shape& b);
// One of the eight corners of a box.
Vec3 corner_of(const Shape& box, int corner);

}  // namespace pliant::contact
