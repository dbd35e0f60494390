#include "solids.hpp"

#include <algorithm>
#include <cmath>

namespace pliant::contact {
namespace {

constexpr double kTiny = 1e-12;  // m
const double kHalfRoot = std::sqrt(0.5);

struct Profile {  // of a body that is round about z: distance and normal in the half plane (rho, z)
  double value, out, up;
};

// A place (rho, z) and the segment from (rho, z) over (d_rho, d_z), seen from the side to which (out, up) points.
void nearer(double rho, double z, const double (&from)[2], const double (&to)[2], double out, double up,
            Profile& best) {
  const double d[2] = {to[0] - from[0], to[1] - from[1]}, size2 = d[0] * d[0] + d[1] * d[1];
  if (size2 < kTiny * kTiny) return;
  const double t = std::clamp(((rho - from[0]) * d[0] + (z - from[1]) * d[1]) / size2, 0.0, 1.0);
  const double x = rho - from[0] - t * d[0], y = z - from[1] - t * d[1], distance = std::hypot(x, y);
  if (distance >= best.value) return;
  best = distance > kTiny ? Profile{distance, x / distance, y / distance} : Profile{distance, out, up};
}

Distance about_axis(const Profile& found, const Vec3& point, double rho) {
  const Vec3 radial = rho > kTiny ? Vec3{point.x / rho, point.y / rho, 0.0} : Vec3{1.0, 0.0, 0.0};
  return {found.value, found.out * radial + Vec3{0.0, 0.0, found.up}, true};
}

// The largest of three negative numbers: a place inside leaves through the nearest face.
int largest(const Vec3& v) { return v.x >= v.y ? (v.x >= v.z ? 0 : 2) : (v.y >= v.z ? 1 : 2); }

}  // namespace

Distance distance_to(const Hole& hole, const Vec3& point) {
  const double rho = std::hypot(point.x, point.y), z = point.z, r = hole.radius, c = hole.chamfer;
  const double far = std::max(rho, r + c) + 1.0;
  Profile best{HUGE_VAL, 0.0, 1.0};
  nearer(rho, z, {r + c, 0.0}, {far, 0.0}, 0.0, 1.0, best);
  nearer(rho, z, {r + c, 0.0}, {r, -c}, -kHalfRoot, kHalfRoot, best);
  nearer(rho, z, {r, -c}, {r, -hole.depth}, -1.0, 0.0, best);
  nearer(rho, z, {r, -hole.depth}, {0.0, -hole.depth}, 0.0, 1.0, best);
  const bool air = z >= 0.0 || (z >= -hole.depth && rho <= r + std::max(0.0, c + z));
  if (!air && best.value > kTiny) best = {-best.value, -best.out, -best.up};
  return about_axis(best, point, rho);
}

Place2 middle_of(const Edge& edge) {
  return {-edge.rounding * (1.0 + std::cos(edge.angle)) / std::sin(edge.angle), -edge.rounding};
}

Distance distance_to(const Edge& edge, const Vec3& point) {
  const Place2 middle = middle_of(edge);
  const double c = std::cos(edge.angle), s = std::sin(edge.angle), y = point.y - middle.y, z = point.z - middle.z;
  const double first = z, second = s * y - c * z;  // over each half plane
  const double size = std::hypot(y, z);
  if (y >= 0.0 && -c * y - s * z <= 0.0) {  // over neither: the line itself is nearest
    if (size < kTiny) return {size - edge.rounding, {0.0, 0.0, 1.0}, true};
    return {size - edge.rounding, {0.0, y / size, z / size}, true};
  }
  if (first >= second) return {first - edge.rounding, {0.0, 0.0, 1.0}, true};
  return {second - edge.rounding, {0.0, s, -c}, true};
}

Distance distance_to_cylinder(double radius, double half, const Vec3& point) {
  const double rho = std::hypot(point.x, point.y), side = point.z < 0.0 ? -1.0 : 1.0;
  const double out = rho - radius, up = std::fabs(point.z) - half;
  Profile found{std::max(out, up), out > up ? 1.0 : 0.0, out > up ? 0.0 : side};
  if (out > 0.0 && up > 0.0) {
    const double size = std::hypot(out, up);
    found = {size, out / size, side * up / size};
  }
  return about_axis(found, point, rho);
}

Distance distance_to_box(const Vec3& half, const Vec3& point) {
  Vec3 over, excess;
  for (int i = 0; i < 3; ++i) {
    over[i] = std::fabs(point[i]) - half[i];
    excess[i] = std::copysign(std::max(over[i], 0.0), point[i]);
  }
  const double size = norm(excess);
  if (size > 0.0) return {size, (1.0 / size) * excess, true};
  const int axis = largest(over);
  Vec3 normal;
  normal[axis] = point[axis] < 0.0 ? -1.0 : 1.0;
  return {over[axis], normal, true};
}

}  // namespace pliant::contact
