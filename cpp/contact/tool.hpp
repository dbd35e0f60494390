// A tool that is not a ball: a cylinder or a box that touches with several points, which share the stiffness.
#pragma once

#include "shapes.hpp"

namespace pliant::contact {

constexpr int kRim = 32;  // points of a rim, evenly round it

// How many contact points a tool has with B; 0 where the pair is not supported. The points of the tool (two rims of a
// cylinder, eight corners of a box) against B come first; then those of B against the tool: the two rims of a hole's
// mouth, the corners of a box, the line of an edge. A round B cannot be touched from outside.
int tool_slots(ShapeType a, const Shape& b);

// The contact point number `slot`.
Touch touch_tool(const Shape& a, const Shape& b, int slot);

// The part of the material's stiffness, damping and bristle that a contact point has: an end of the tool, pressed flat
// on a plane, is as stiff as the material.
double share_of(ShapeType a, const Shape& b, int slot);

}  // namespace pliant::contact
