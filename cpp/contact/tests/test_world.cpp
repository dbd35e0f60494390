// The core without Python and without a physics engine: two bodies in arrays that a test moves itself.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "../../tests/checks.hpp"
#include "../world.hpp"

namespace pliant::contact {
namespace {

using namespace pliant::testing;

const Material kSteel{1e4, 50.0, 1e-4, 0.5, 0.3, 1e-3, 1e4, 50.0};
constexpr double kIdentity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};

// Geom i belongs to body i. Every array is exactly as large as the views say: a sanitizer sees what is beyond.
struct Scene {
  explicit Scene(ShapeType a, ShapeType b) : type{static_cast<int32_t>(a), static_cast<int32_t>(b)} {
    for (int i = 0; i < 2; ++i) std::copy(kIdentity, kIdentity + 9, rotation.begin() + 9 * i);
  }
  Views views() {
    return {type.data(),
            body.data(),
            size.data(),
            position.data(),
            rotation.data(),
            root.data(),
            centre.data(),
            centre.data(),
            velocity.data(),
            force.data(),
            joint.data(),
            2,
            2,
            static_cast<int>(joint.size())};
  }
  std::vector<int32_t> type, body{0, 1}, root{0, 1};
  std::vector<double> size{0.1, 0.1, 0.1, 0.2, 0.2, 0.2}, position = std::vector<double>(6, 0.0);
  std::vector<double> rotation = std::vector<double>(18), centre = std::vector<double>(6, 0.0);
  std::vector<double> velocity = std::vector<double>(12, 0.0), force = std::vector<double>(12, 0.0);
  std::vector<double> joint = std::vector<double>(1, 0.0);
};

struct Results {
  explicit Results(int slots) : bristles(kBristleSize * slots), force(3 * slots), point(3 * slots), depth(slots) {}
  Output out() { return {force.data(), point.data(), depth.data()}; }
  std::vector<double> bristles, force, point, depth;
};

// Every pair that has contact points, at random places: unit normals, equal and opposite forces, nothing from the heap.
void run_pair(ShapeType a, ShapeType b, bool hollow, const Form* form = nullptr, bool tool = false) {
  Scene scene(a, b);
  World world;
  const Views views = scene.views();
  const int first = world.add_pair(views, 0, 1, kSteel, hollow, form, tool);
  check(tool || (first < 0) == (slot_count(a, form ? form->type : b, hollow) == 0),
        "a pair without contact points is refused", "pair");
  if (first < 0) return;
  Results results(world.slots());
  std::vector<double> push(12, 0.0);
  Noise noise;
  int touching = 0;
  const int before = allocations;
  for (int trial = 0; trial < 300; ++trial) {
    for (int i = 0; i < 3; ++i) scene.position[i] = scene.centre[i] = 0.4 * noise();
    for (double& v : scene.velocity) v = 0.1 * noise();
    check(world.evaluate(views, 1e-4, push.data(), results.bristles.data(), results.out()), "forces are sound", "pair");
    double sum = 0.0, total = 0.0;
    for (int i = 0; i < 3; ++i) {
      sum += std::fabs(scene.force[i] + scene.force[6 + i]);
      total += std::fabs(scene.force[i]);
    }
    check(sum <= 1e-9 * (1.0 + total), "what acts on A acts on B the other way", "pair");
    for (int i = 0; i < world.slots(); ++i) touching += results.depth[i] > 0.0;
  }
  check(allocations == before, "an evaluation takes nothing from the heap", "pair");
  check(touching > 0, "some of the places touch", "pair");
}

// A ball at rest 1 mm deep in a plane: K p against the normal, and nothing across it.
void run_known_force() {
  Scene scene(ShapeType::kSphere, ShapeType::kPlane);
  scene.position[2] = scene.centre[2] = 0.099;
  World world;
  const Views views = scene.views();
  world.add_pair(views, 0, 1, kSteel, false);
  Results results(world.slots());
  std::vector<double> push(12, 0.0);
  push[0] = 7.0;
  world.evaluate(views, 1e-4, push.data(), results.bristles.data(), results.out());
  check(std::fabs(results.force[2] - 10.0) < 1e-9, "1 mm of 1e4 N/m is 10 N", "plane");
  check(results.force[0] == 0.0 && results.force[1] == 0.0, "nothing slides", "plane");
  check(scene.force[0] == 7.0 && std::fabs(scene.force[2] - 10.0) < 1e-9, "a push is added", "plane");
  scene.velocity[3] = 1.0;  // m/s along x: the bristle gives way
  for (int k = 0; k < 200; ++k) world.evaluate(views, 1e-4, push.data(), results.bristles.data(), results.out());
  check(std::fabs(results.force[0] + 0.3 * 10.0) < 0.05, "sliding, friction is mu_dynamic times the force", "plane");
  scene.velocity[3] = 0.0;
  scene.position[2] = std::numeric_limits<double>::quiet_NaN();
  check(!world.evaluate(views, 1e-4, push.data(), results.bristles.data(), results.out()), "NaN is found", "plane");
}

// A tool flat on a plane, 1 mm deep: its end is as stiff as the material, and its points press alike.
void run_tool() {
  for (ShapeType type : {ShapeType::kCylinder, ShapeType::kBox}) {
    Scene scene(type, ShapeType::kPlane);
    scene.position[2] = scene.centre[2] = 0.099;
    World world;
    const Views views = scene.views();
    world.add_pair(views, 0, 1, kSteel, false, nullptr, true);
    Results results(world.slots());
    const std::vector<double> push(12, 0.0);
    world.evaluate(views, 1e-4, push.data(), results.bristles.data(), results.out());
    check(std::fabs(scene.force[2] - 10.0) < 1e-9, "1 mm of 1e4 N/m is 10 N", "tool");
    for (int i = 0; i < 6; ++i) check(i == 2 || std::fabs(scene.force[i]) < 1e-9, "and nothing else", "tool");
  }
}

// The loop stops where the engine blows up, and says after how many steps.
thread_local int steps_taken = 0;
void half_step(const void*, void*) {}
void faster(const void*, void* data) {
  ++steps_taken;
  if (steps_taken == 4) static_cast<Scene*>(data)->joint[0] = std::numeric_limits<double>::infinity();
}
void run_loop() {
  Scene scene(ShapeType::kSphere, ShapeType::kPlane);
  scene.position[2] = 0.5;
  World world;
  const Views views = scene.views();
  world.add_pair(views, 0, 1, kSteel, false);
  Results results(world.slots());
  const std::vector<double> push(12, 0.0);
  const auto advance = [&](int count) {
    return world.advance(views, half_step, faster, nullptr, &scene, count, 1e-4, push.data(), results.bristles.data(),
                         results.out());
  };
  check(advance(3) == 3, "three sound steps are three", "loop");
  check(advance(5) == 0, "the step that blows up does not count", "loop");
  check(advance(5) == 0 && steps_taken == 4, "nothing moves afterwards", "loop");
}

void run() {
  const ShapeType all[] = {ShapeType::kPlane, ShapeType::kSphere, ShapeType::kCapsule, ShapeType::kCylinder,
                           ShapeType::kBox};
  for (ShapeType a : all)
    for (ShapeType b : all)
      for (bool hollow : {false, true}) run_pair(a, b, hollow);
  const Form hole{ShapeType::kHole, nullptr, {0.15, 0.2, 0.02}}, edge{ShapeType::kEdge, nullptr, {}, {1.3, 0.02}};
  for (const Form* form : {&hole, &edge}) {
    for (ShapeType a : all) run_pair(a, ShapeType::kSphere, false, form);
    for (ShapeType a : {ShapeType::kCylinder, ShapeType::kBox}) run_pair(a, ShapeType::kSphere, false, form, true);
  }
  for (ShapeType a : all)
    for (ShapeType b : all)
      for (bool hollow : {false, true}) run_pair(a, b, hollow, nullptr, true);
  run_tool();
  run_known_force();
  run_loop();
}

}  // namespace
}  // namespace pliant::contact

int main() {
  pliant::contact::run();
  return pliant::testing::result();
}
