// Where two primitive shapes touch. Shapes are MuJoCo geoms: same types, sizes and local axes.
#pragma once

#include "field.hpp"
#include "vec3.hpp"

namespace pliant::contact {

// mjtGeom's values, and one of our own: a part whose surface is a sampled distance.
enum class ShapeType : int { kPlane = 0, kSphere = 2, kCapsule = 3, kCylinder = 5, kBox = 6, kField = 1000 };

struct Shape {
  ShapeType type;
  Vec3 size;  // sphere, cylinder: radius; capsule: radius, half length along local z; box: half extents; plane: unused
  Vec3 position;                 // m, world
  Rotation rotation;             // R_world_shape
  bool hollow;                   // of B, a sphere or cylinder: the material is outside of it
  const Field* field = nullptr;  // of kField, in the shape's axes
};

struct Touch {
  Vec3 point;          // m, world, halfway between the two surfaces
  Vec3 normal;         // unit, from B towards A
  double penetration;  // m, above zero where the shapes overlap
};

// How many contact points a pair can have; 0 where the pair is not supported. A is a sphere, capsule or box, B a plane,
// box, sphere, cylinder without ends or field. On a plane, a field and in a hollow B a box acts through its eight
// corners, a capsule through its two ends; a box does not act on a round B from outside.
int slot_count(ShapeType a, ShapeType b, bool hollow);

// The contact point number `slot` of a pair.
Touch touch(const Shape& a, const Shape& b, int slot);

}  // namespace pliant::contact
