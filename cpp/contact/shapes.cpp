#include "shapes.hpp"

#include <algorithm>
#include <array>

namespace pliant::contact {
namespace {

constexpr int kCorners = 8;
constexpr double kTiny = 1e-12;

// The part of a vector that is perpendicular to a unit axis.
Vec3 across(const Vec3& v, const Vec3& axis) { return v - dot(v, axis) * axis; }

Touch against_plane(const Ball& ball, const Shape& plane) {
  const Vec3 normal = plane.rotation.column(2);
  const double gap = dot(normal, ball.centre - plane.position) - ball.radius;
  return {ball.centre - (ball.radius + 0.5 * gap) * normal, normal, -gap};
}

// A sphere about its centre, or a cylinder about its axis, from outside or from within. Args: apart: from the centre or
// the axis to the ball.
Touch against_round(const Ball& ball, const Shape& b, const Vec3& apart) {
  const double distance = norm(apart), side = b.hollow ? -1.0 : 1.0;
  const Vec3 normal = side * (distance > kTiny ? (1.0 / distance) * apart : b.rotation.column(0));
  const double gap = side * (distance - b.size.x) - ball.radius;
  return {ball.centre - (ball.radius + 0.5 * gap) * normal, normal, -gap};
}

Touch against_sphere(const Ball& ball, const Shape& sphere) {
  return against_round(ball, sphere, ball.centre - sphere.position);
}

Touch against_cylinder(const Ball& ball, const Shape& cylinder) {
  return against_round(ball, cylinder, across(ball.centre - cylinder.position, cylinder.rotation.column(2)));
}

// Outside the samples there is nothing to touch; a place that is no number stays one.
Touch against_form(const Ball& ball, const Shape& part) {
  constexpr double kFar = 1.0;  // m
  const Vec3 up = part.rotation.column(2);
  const Distance found = part.form->at(part.rotation.to_local(ball.centre - part.position));
  if (!found.known) return {ball.centre, up, -kFar + 0.0 * dot(ball.centre, ball.centre)};
  const double length = norm(found.gradient);
  const Vec3 normal = length > kTiny ? part.rotation.to_world((1.0 / length) * found.gradient) : up;
  const double gap = found.value - ball.radius;
  return {ball.centre - (ball.radius + 0.5 * gap) * normal, normal, -gap};
}

// A centre inside the box leaves through the nearest face.
Touch inside_box(const Ball& ball, const Shape& box, const Vec3& local) {
  int axis = 0;
  for (int i = 1; i < 3; ++i)
    if (box.size[i] - std::abs(local[i]) < box.size[axis] - std::abs(local[axis])) axis = i;
  const double side = local[axis] < 0.0 ? -1.0 : 1.0;
  const Vec3 normal = side * box.rotation.column(axis);
  const double gap = std::abs(local[axis]) - box.size[axis] - ball.radius;
  return {ball.centre - (ball.radius + 0.5 * gap) * normal, normal, -gap};
}

Touch against_box(const Ball& ball, const Shape& box) {
  const Vec3 local = box.rotation.to_local(ball.centre - box.position);
  Vec3 excess;
  for (int i = 0; i < 3; ++i) excess[i] = local[i] - std::clamp(local[i], -box.size[i], box.size[i]);
  const double distance = norm(excess);
  if (distance < kTiny) return inside_box(ball, box, local);
  const Vec3 normal = box.rotation.to_world((1.0 / distance) * excess);
  const double gap = distance - ball.radius;
  return {ball.centre - (ball.radius + 0.5 * gap) * normal, normal, -gap};
}

// Half the derivative of the squared distance between a + t d and a box centred at the origin; grows with t.
double distance_slope(const Vec3& a, const Vec3& d, const Vec3& half, double t) {
  double slope = 0.0;
  for (int i = 0; i < 3; ++i) {
    const double x = a[i] + t * d[i];
    slope += d[i] * (x - std::clamp(x, -half[i], half[i]));
  }
  return slope;
}

// Where a piecewise linear, growing slope first reaches `level` on [t0, 1], between the breakpoints given in order.
double first_reach(const Vec3& a, const Vec3& d, const Vec3& half, const double* t, int count, double level) {
  double before = distance_slope(a, d, half, t[0]);
  if (before >= level) return t[0];
  for (int k = 1; k < count; ++k) {
    const double after = distance_slope(a, d, half, t[k]);
    if (after >= level) return t[k - 1] + (t[k] - t[k - 1]) * (level - before) / (after - before);
    before = after;
  }
  return t[count - 1];
}

// Adds a value to a short sorted list.
void insert_sorted(std::array<double, 8>& list, int& count, double value) {
  int at = count++;
  for (; at > 0 && list[at - 1] > value; --at) list[at] = list[at - 1];
  list[at] = value;
}

// Parameter in [0, 1] of the point of a segment nearest to a box, both in the box's axes; the middle one if there are
// many.
double nearest_on_segment(const Vec3& a, const Vec3& d, const Vec3& half) {
  std::array<double, 8> t{0.0, 1.0};
  int count = 2;
  for (int i = 0; i < 3; ++i)
    for (const double face : {-half[i], half[i]}) {
      const double crossing = std::abs(d[i]) > kTiny ? (face - a[i]) / d[i] : -1.0;
      if (crossing > 0.0 && crossing < 1.0) insert_sorted(t, count, crossing);
    }
  const double level = 1e-9 * dot(d, d);  // below it the segment counts as parallel to the face
  const double low = first_reach(a, d, half, t.data(), count, -level);
  const double high = first_reach(a, d, half, t.data(), count, level);
  return 0.5 * (low + high);
}

Ball ball_of_sphere(const Shape& a) { return {a.position, a.size.x}; }

// A form without ends: what has no nearest point on a capsule's axis in closed form.
bool open_form(ShapeType type) {
  return type == ShapeType::kField || type == ShapeType::kHole || type == ShapeType::kEdge;
}

// The point of a capsule's axis that matters for B, with the capsule's radius.
Ball ball_of_capsule(const Shape& a, const Shape& b, int slot) {
  const Vec3 half_axis = a.size.y * a.rotation.column(2);
  if (b.type == ShapeType::kPlane || open_form(b.type) || b.hollow)
    return {slot == 0 ? a.position - half_axis : a.position + half_axis, a.size.x};
  const Vec3 start = a.position - half_axis;
  const Vec3 along = 2.0 * half_axis;
  double t = 0.0;
  if (b.type == ShapeType::kBox) {
    t = nearest_on_segment(b.rotation.to_local(start - b.position), b.rotation.to_local(along), b.size);
  } else {
    // nearest to the centre, or to the axis; the middle where the two run side by side
    const bool round = b.type == ShapeType::kCylinder;
    const Vec3 way = round ? across(along, b.rotation.column(2)) : along;
    const double length2 = dot(way, way);
    t = length2 > kTiny ? std::clamp(dot(b.position - start, way) / length2, 0.0, 1.0) : 0.5;
  }
  return {start + t * along, a.size.x};
}

}  // namespace

int slot_count(ShapeType a, ShapeType b, bool hollow) {
  const bool round = b == ShapeType::kSphere || b == ShapeType::kCylinder;
  if (hollow && !round) return 0;
  const bool open = b == ShapeType::kPlane || open_form(b);
  if (!round && !open && b != ShapeType::kBox) return 0;
  if (a == ShapeType::kSphere) return 1;
  if (a == ShapeType::kCapsule) return open || hollow ? 2 : 1;
  if (a == ShapeType::kBox) return round && !hollow ? 0 : kCorners;
  return 0;
}

Vec3 corner_of(const Shape& box, int corner) {
  const Vec3 local{(corner & 1 ? 1.0 : -1.0) * box.size.x, (corner & 2 ? 1.0 : -1.0) * box.size.y,
                   (corner & 4 ? 1.0 : -1.0) * box.size.z};
  return box.position + box.rotation.to_world(local);
}

Touch touch_ball(const Ball& ball, const Shape& b) {
  if (b.form) return against_form(ball, b);
  switch (b.type) {
    case ShapeType::kPlane:
      return against_plane(ball, b);
    case ShapeType::kSphere:
      return against_sphere(ball, b);
    case ShapeType::kCylinder:
      return against_cylinder(ball, b);
    default:
      return against_box(ball, b);
  }
}

Touch touch(const Shape& a, const Shape& b, int slot) {
  switch (a.type) {
    case ShapeType::kBox:
      return touch_ball({corner_of(a, slot), 0.0}, b);
    case ShapeType::kCapsule:
      return touch_ball(ball_of_capsule(a, b, slot), b);
    default:
      return touch_ball(ball_of_sphere(a), b);
  }
}

}  // namespace pliant::contact
