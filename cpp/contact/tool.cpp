#include "tool.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace pliant::contact {
namespace {

constexpr int kCorners = 8, kFaceCorners = 4, kEnds = 2;
constexpr double kPi = 3.14159265358979323846;

struct Direction {
  double x, y;
};

const std::array<Direction, kRim> kRound = [] {
  std::array<Direction, kRim> found{};
  for (int i = 0; i < kRim; ++i) found[i] = {std::cos(2.0 * kPi * i / kRim), std::sin(2.0 * kPi * i / kRim)};
  return found;
}();

Vec3 rim_point(double radius, double z, int index) { return {radius * kRound[index].x, radius * kRound[index].y, z}; }

bool is_tool(ShapeType a) { return a == ShapeType::kCylinder || a == ShapeType::kBox; }

int own_points(ShapeType a) { return a == ShapeType::kCylinder ? kEnds * kRim : kCorners; }

Vec3 own_point(const Shape& a, int slot) {
  if (a.type == ShapeType::kBox) return corner_of(a, slot);
  return a.position + a.rotation.to_world(rim_point(a.size.x, slot < kRim ? a.size.y : -a.size.y, slot % kRim));
}

Distance distance_to_tool(const Shape& a, const Vec3& place) {
  const Vec3 local = a.rotation.to_local(place - a.position);
  return a.type == ShapeType::kCylinder ? distance_to_cylinder(a.size.x, a.size.y, local)
                                        : distance_to_box(a.size, local);
}

// A ball of B against the tool's own surface. The normal is from B towards A, so into the tool.
Touch from_below(const Shape& a, const Ball& ball) {
  const Distance found = distance_to_tool(a, ball.centre);
  const Vec3 normal = -a.rotation.to_world(found.gradient);
  return {ball.centre + 0.5 * (ball.radius + found.value) * normal, normal, ball.radius - found.value};
}

// The place of a straight line that is deepest in the tool, or nearest to it: the distance to a convex solid is convex
// along a line. The middle one if there are many.
Vec3 deepest(const Shape& a, const Vec3& place, const Vec3& along) {
  const double reach = norm(a.size) + a.size.y;  // as far as any shape of that size
  const double middle = dot(a.position - place, along);
  double low = middle - reach, high = middle + reach, ends[2];
  for (int side = 0; side < 2; ++side) {
    double from = low, to = high;
    for (int i = 0; i < 48; ++i) {
      const double first = from + (to - from) / 3.0, second = to - (to - from) / 3.0;
      const double one = distance_to_tool(a, place + first * along).value;
      const double other = distance_to_tool(a, place + second * along).value;
      const bool left = side == 0 ? one <= other : one < other;
      (left ? to : from) = left ? second : first;
    }
    ends[side] = 0.5 * (from + to);
  }
  return place + 0.5 * (ends[0] + ends[1]) * along;
}

Vec3 mouth_point(const Shape& b, int index) {
  const Hole& hole = b.form->hole;
  const bool upper = index < kRim;
  return b.position + b.rotation.to_world(rim_point(upper ? hole.radius + hole.chamfer : hole.radius,
                                                    upper ? 0.0 : -hole.chamfer, index % kRim));
}

Touch from_edge(const Shape& a, const Shape& b) {
  const Edge& edge = b.form->edge;
  const Place2 middle = middle_of(edge);
  const Vec3 on_line = b.position + b.rotation.to_world({0.0, middle.y, middle.z});
  return from_below(a, {deepest(a, on_line, b.rotation.column(0)), edge.rounding});
}

int points_of_other(const Shape& b) {
  if (b.type == ShapeType::kBox) return kCorners;
  if (b.type == ShapeType::kEdge) return 1;
  if (b.type == ShapeType::kHole) return b.form->hole.chamfer > 0.0 ? 2 * kRim : kRim;
  return 0;
}

}  // namespace

int tool_slots(ShapeType a, const Shape& b) {
  const bool round = b.type == ShapeType::kSphere || b.type == ShapeType::kCylinder;
  const bool known = round ? b.hollow : b.form || b.type == ShapeType::kPlane || b.type == ShapeType::kBox;
  return is_tool(a) && known ? own_points(a) + points_of_other(b) : 0;
}

Touch touch_tool(const Shape& a, const Shape& b, int slot) {
  const int own = own_points(a.type);
  if (slot < own) return touch_ball({own_point(a, slot), 0.0}, b);
  switch (b.type) {
    case ShapeType::kHole:
      return from_below(a, {mouth_point(b, slot - own), 0.0});
    case ShapeType::kEdge:
      return from_edge(a, b);
    default:
      return from_below(a, {corner_of(b, slot - own), 0.0});
  }
}

double share_of(ShapeType a, const Shape& b, int slot) {
  if (slot < own_points(a)) return 1.0 / (a == ShapeType::kCylinder ? kRim : kFaceCorners);
  return b.type == ShapeType::kHole ? 1.0 / kRim : b.type == ShapeType::kEdge ? 1.0 : 1.0 / kFaceCorners;
}

}  // namespace pliant::contact
