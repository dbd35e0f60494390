// Triangles, samples of their distance, and a ball that presses on them.
#include <cmath>
#include <limits>
#include <vector>

#include "../../tests/checks.hpp"
#include "../sampled.hpp"
#include "../shapes.hpp"

namespace pliant::contact {
namespace {

using namespace pliant::testing;

// A cube of side 2 about the origin; without its last two triangles, those of the top, it is an open shell.
const double kCorners[] = {-1, -1, -1, 1, -1, -1, 1, 1, -1, -1, 1, -1, -1, -1, 1, 1, -1, 1, 1, 1, 1, -1, 1, 1};
const int32_t kFaces[] = {0, 2, 1, 0, 3, 2, 0, 1, 5, 0, 5, 4, 1, 2, 6, 1, 6, 5,
                          2, 3, 7, 2, 7, 6, 3, 0, 4, 3, 4, 7, 4, 5, 6, 4, 6, 7};

double of_a_cube(const Vec3& p) {
  double outside = 0.0, inside = -std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    const double over = std::fabs(p[i]) - 1.0;
    outside += over > 0.0 ? over * over : 0.0;
    inside = std::fmax(inside, over);
  }
  return inside > 0.0 ? std::sqrt(outside) : inside;
}

void run_triangles() {
  const Mesh cube(kCorners, 8, kFaces, 12);
  Noise noise;
  for (int trial = 0; trial < 2000; ++trial) {
    const Vec3 p{3.0 * noise(), 3.0 * noise(), 3.0 * noise()};
    const MeshPlace found = cube.nearest(p);
    check(std::fabs(found.distance - of_a_cube(p)) < 1e-12, "the distance of a cube", "triangles");
    check(std::fabs(norm(p - found.point) - std::fabs(found.distance)) < 1e-12, "as far as the place", "triangles");
    check(std::fabs(norm(found.normal) - 1.0) < 1e-12, "a unit normal", "triangles");
  }
  const Mesh shell(kCorners, 8, kFaces, 10);
  check(shell.nearest({0.0, 0.0, -0.5}).distance < 0.0, "over the floor of an open box is inside", "shell");
  check(shell.nearest({0.0, 0.0, -1.5}).distance > 0.0, "under it is outside", "shell");
  check(shell.nearest({0.9, 0.9, 1.5}).distance > 0.0, "beyond the rim is outside", "shell");
}

struct Samples {  // exactly as many as the field says: a sanitizer sees what is beyond
  explicit Samples(int n) : values(static_cast<size_t>(n * n * n)), field{{-2, -2, -2}, 4.0 / (n - 1), {n, n, n}, {}} {
    field.values = values.data();
  }
  template <class F>
  void fill(const F& f) {
    size_t at = 0;
    for (int i = 0; i < field.count[0]; ++i)
      for (int j = 0; j < field.count[1]; ++j)
        for (int k = 0; k < field.count[2]; ++k)
          values[at++] = f(field.low + field.step * Vec3{double(i), double(j), double(k)});
  }
  std::vector<double> values;
  Field field;
};

// The interpolant meets every quadratic, and its gradient is its slope everywhere.
void run_samples() {
  Samples samples(9);
  const auto f = [](const Vec3& p) { return 0.3 + p.x * p.x - 0.5 * p.y * p.z + 2.0 * p.z; };
  samples.fill(f);
  Noise noise;
  const double inf = std::numeric_limits<double>::infinity();
  for (int trial = 0; trial < 2000; ++trial) {
    const Vec3 p{4.2 * noise(), 4.2 * noise(), 4.2 * noise()};
    const Distance found = samples.field.at(p);
    bool within = true;
    for (int i = 0; i < 3; ++i) within = within && p[i] >= -1.5 && p[i] < 1.5;
    check(found.known == within, "known where four samples stand round it", "samples");
    if (!found.known) continue;
    check(std::fabs(found.value - f(p)) < 1e-12, "a quadratic is met", "samples");
    const Vec3 slope{2.0 * p.x, -0.5 * p.z, -0.5 * p.y + 2.0};
    check(norm(found.gradient - slope) < 1e-12, "its slope too", "samples");
  }
  for (double odd : {std::nan(""), inf, -inf}) check(!samples.field.at({odd, 0, 0}).known, "no number", "samples");
}

// A ball of radius 0.2 whose centre is 0.15 over the cube's top presses 0.05 deep, upwards; a place without a number
// is not taken for a free one.
void run_ball() {
  const Mesh cube(kCorners, 8, kFaces, 12);
  Samples samples(33);
  samples.fill([&](const Vec3& p) { return cube.nearest(p).distance; });
  const double identity[] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  const Form form{ShapeType::kField, &samples.field};
  const Shape part{ShapeType::kField, {}, {10.0, 0.0, 0.0}, Rotation{identity}, false, &form};
  Shape ball{ShapeType::kSphere, {0.2, 0.0, 0.0}, {10.1, 0.2, 1.15}, Rotation{identity}, false};
  const int before = allocations;
  const Touch found = touch(ball, part, 0);
  check(std::fabs(found.penetration - 0.05) < 1e-9, "as deep as it is", "ball");
  check(norm(found.normal - Vec3{0.0, 0.0, 1.0}) < 1e-9, "pushed up", "ball");
  check(std::fabs(found.point.z - 0.975) < 1e-9, "halfway between the surfaces", "ball");
  const MeshPlace place = nearest(cube, samples.field, 0.5, {0.1, 0.2, 1.15});
  check(std::fabs(place.distance - 0.15) < 1e-9 && std::fabs(place.point.z - 1.0) < 1e-9, "the place below", "ball");
  check(allocations == before, "nothing from the heap", "ball");
  ball.position.z = 7.0;
  check(touch(ball, part, 0).penetration < 0.0, "outside the samples there is nothing", "ball");
  ball.position.z = std::nan("");
  check(std::isnan(touch(ball, part, 0).penetration), "a place without a number is seen", "ball");
}

void run() {
  run_triangles();
  run_samples();
  run_ball();
}

}  // namespace
}  // namespace pliant::contact

int main() {
  pliant::contact::run();
  return pliant::testing::result();
}
