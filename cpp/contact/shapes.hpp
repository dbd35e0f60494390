// Where two primitive shapes touch. Shapes are MuJoCo geoms: same types, sizes and local axes.
#pragma once

#include "vec3.hpp"

namespace pliant::contact {

enum class ShapeType : int { kPlane = 0, kSphere = 2, kCapsule = 3, kBox = 6 };  // mjtGeom's values

struct Shape {
  ShapeType type;
  Vec3 size;         // sphere: radius; capsule: radius, half length along local z; box: half extents; plane: unused
  Vec3 position;     // m, world
  Rotation rotation; // R_world_shape
};

struct Touch {
  Vec3 point;          // m, world, halfway between the two surfaces
  Vec3 normal;         // unit, from B towards A
  double penetration;  // m, above zero where the shapes overlap
};

// How many contact points a pair can have; 0 where the pair is not supported. A is a sphere, capsule or box,
// B a plane, box or sphere. A box acts through its eight corners, a capsule on a plane through its two ends.
int slot_count(ShapeType a, ShapeType b);

// The contact point number `slot` of a pair.
Touch touch(const Shape& a, const Shape& b, int slot);

}  // namespace pliant::contact
