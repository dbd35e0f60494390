// Signed distances of solids in closed form, in the solid's own axes.
#pragma once

#include "field.hpp"
#include "../shared/vec3.hpp"

namespace pliant::contact {

// A block with a round hole along -z of its face z = 0, bevelled by 45 degrees at the mouth, with a flat bottom.
struct Hole {
  double radius, depth, chamfer;  // m
};

// Two half planes that meet at a rounded line along x: z = 0 towards -y, and one that comes down from the line.
struct Edge {
  double angle;     // rad, of the material, below pi
  double rounding;  // m, radius
};

// Distance and outward unit normal (where two are as near, one of them). Every value is the distance to the surface.
Distance distance_to(const Hole& hole, const Vec3& point);
Distance distance_to(const Edge& edge, const Vec3& point);
// A cylinder about z with its ends. Args: half: half length, m.
Distance distance_to_cylinder(double radius, double half, const Vec3& point);
// A box. Args: half: half edges, m.
Distance distance_to_box(const Vec3& half, const Vec3& point);

// (y, z) of the middle of the rounded line.
struct Place2 {
  double y, z;
};
Place2 middle_of(const Edge& edge);

}  // namespace pliant::contact
