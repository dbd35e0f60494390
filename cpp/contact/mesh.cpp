#include "mesh.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <utility>

namespace pliant::contact {
namespace {

constexpr int kLeaf = 4;       // triangles
constexpr int kDeepest = 64;   // levels of boxes, far beyond what halving needs
constexpr int kNoFeature = 3;  // index beside those of three edges or corners

double box_distance2(const Vec3& low, const Vec3& high, const Vec3& p) {
  double sum = 0.0;
  for (int i = 0; i < 3; ++i) {
    const double out = std::max({low[i] - p[i], 0.0, p[i] - high[i]});
    sum += out * out;
  }
  return sum;
}

struct OnTriangle {
  Vec3 point;
  int corner;  // 0…2 where it is a corner, else kNoFeature
  int edge;    // the edge opposite to that corner, where it is on an edge, else kNoFeature
};

// Nearest place of a triangle by the regions of its corners and edges (Ericson 2005, 5.1.5).
OnTriangle nearest_on(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0.0 && d2 <= 0.0) return {a, 0, kNoFeature};
  const Vec3 bp = p - b;
  const double d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0.0 && d4 <= d3) return {b, 1, kNoFeature};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return {a + (d1 / (d1 - d3)) * ab, kNoFeature, 2};
  const Vec3 cp = p - c;
  const double d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0.0 && d5 <= d6) return {c, 2, kNoFeature};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return {a + (d2 / (d2 - d6)) * ac, kNoFeature, 1};
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0)
    return {b + ((d4 - d3) / ((d4 - d3) + (d5 - d6))) * (c - b), kNoFeature, 0};
  const double scale = 1.0 / (va + vb + vc);
  return {a + (vb * scale) * ab + (vc * scale) * ac, kNoFeature, kNoFeature};
}

Vec3 unit(const Vec3& v) {
  const double length = norm(v);
  return length > 0.0 ? (1.0 / length) * v : v;
}

}  // namespace

Mesh::Mesh(const double* vertices, int vertex_count, const int32_t* triangles, int triangle_count) {
  for (int i = 0; i < vertex_count; ++i) vertices_.push_back(load(vertices + 3 * i));
  for (int i = 0; i < triangle_count; ++i) {
    Triangle made{};
    for (int k = 0; k < 3; ++k) made.corner[k] = triangles[3 * i + k];
    const Vec3 &a = vertices_[made.corner[0]], &b = vertices_[made.corner[1]], &c = vertices_[made.corner[2]];
    made.normal = unit(cross(b - a, c - a));
    triangles_.push_back(made);
  }
  connect();
  order_.resize(triangles_.size());
  std::iota(order_.begin(), order_.end(), 0);
  nodes_.push_back({});
  split(0, 0, triangle_count, 0);
}

// Normals of edges and corners, and where the rim is.
void Mesh::connect() {
  vertex_normal_.assign(vertices_.size(), {});
  vertex_rim_.assign(vertices_.size(), false);
  std::map<std::pair<int, int>, std::pair<Vec3, int>> edges;
  const auto key = [](int a, int b) { return std::make_pair(std::min(a, b), std::max(a, b)); };
  for (const Triangle& t : triangles_)
    for (int k = 0; k < 3; ++k) {
      const int here = t.corner[k], next = t.corner[(k + 1) % 3], last = t.corner[(k + 2) % 3];
      const Vec3 u = unit(vertices_[next] - vertices_[here]), v = unit(vertices_[last] - vertices_[here]);
      const double angle = std::acos(std::clamp(dot(u, v), -1.0, 1.0));
      vertex_normal_[here] = vertex_normal_[here] + angle * t.normal;
      auto& [sum, faces] = edges[key(next, last)];
      sum = sum + t.normal;
      ++faces;
    }
  for (Triangle& t : triangles_)
    for (int k = 0; k < 3; ++k) {
      const int next = t.corner[(k + 1) % 3], last = t.corner[(k + 2) % 3];
      const auto& [sum, faces] = edges[key(next, last)];
      t.edge_normal[k] = unit(sum);
      t.rim[k] = faces == 1;
      if (t.rim[k]) vertex_rim_[next] = vertex_rim_[last] = true;
    }
  for (Vec3& n : vertex_normal_) n = unit(n);
}

// Halves the longest side of the box round the triangles' middles.
void Mesh::split(int node, int first, int count, int depth) {
  const auto middle = [this](int t) {
    const int* c = triangles_[t].corner;
    return (1.0 / 3.0) * (vertices_[c[0]] + vertices_[c[1]] + vertices_[c[2]]);
  };
  const Vec3 start = vertices_[triangles_[order_[first]].corner[0]];
  Vec3 low = start, high = start, near = middle(order_[first]), far = near;
  for (int i = first; i < first + count; ++i) {
    const Vec3 m = middle(order_[i]);
    for (int axis = 0; axis < 3; ++axis) {
      near[axis] = std::min(near[axis], m[axis]);
      far[axis] = std::max(far[axis], m[axis]);
      for (int k = 0; k < 3; ++k) {
        const double x = vertices_[triangles_[order_[i]].corner[k]][axis];
        low[axis] = std::min(low[axis], x);
        high[axis] = std::max(high[axis], x);
      }
    }
  }
  if (count <= kLeaf || depth >= kDeepest) {
    nodes_[node] = {low, high, first, count};
    return;
  }
  int axis = 0;
  for (int i = 1; i < 3; ++i)
    if (far[i] - near[i] > far[axis] - near[axis]) axis = i;
  const int half = count / 2;
  std::nth_element(order_.begin() + first, order_.begin() + first + half, order_.begin() + first + count,
                   [&](int a, int b) { return middle(a)[axis] < middle(b)[axis]; });
  const int child = static_cast<int>(nodes_.size());
  nodes_[node] = {low, high, child, 0};
  nodes_.push_back({});
  nodes_.push_back({});
  split(child, first, half, depth + 1);
  split(child + 1, first + half, count - half, depth + 1);
}

void Mesh::closer(const Triangle& t, const Vec3& p, double& best2, MeshPlace& found) const {
  const OnTriangle on = nearest_on(vertices_[t.corner[0]], vertices_[t.corner[1]], vertices_[t.corner[2]], p);
  const Vec3 apart = p - on.point;
  const double distance2 = dot(apart, apart);
  if (distance2 >= best2) return;
  best2 = distance2;
  bool rim = false;
  Vec3 normal = t.normal;
  if (on.corner < kNoFeature) {
    normal = vertex_normal_[t.corner[on.corner]];
    rim = vertex_rim_[t.corner[on.corner]];
  } else if (on.edge < kNoFeature) {
    normal = t.edge_normal[on.edge];
    rim = t.rim[on.edge];
  }
  const double side = rim || dot(normal, apart) >= 0.0 ? 1.0 : -1.0;
  found = {side * std::sqrt(distance2), on.point, normal};
}

MeshPlace Mesh::nearest(const Vec3& point) const {
  MeshPlace found{};
  double best2 = HUGE_VAL;
  std::array<std::pair<int, double>, 2 * kDeepest + 2> open;
  int count = 0;
  open[count++] = {0, 0.0};
  while (count > 0) {
    const auto [index, least] = open[--count];
    if (least >= best2) continue;
    const Node& node = nodes_[index];
    if (node.count > 0) {
      for (int i = node.first; i < node.first + node.count; ++i) closer(triangles_[order_[i]], point, best2, found);
      continue;
    }
    std::pair<int, double> one{node.first, 0.0}, two{node.first + 1, 0.0};
    one.second = box_distance2(nodes_[one.first].low, nodes_[one.first].high, point);
    two.second = box_distance2(nodes_[two.first].low, nodes_[two.first].high, point);
    if (one.second < two.second) std::swap(one, two);
    open[count++] = one;  // the nearer box is looked into first
    open[count++] = two;
  }
  return found;
}

}  // namespace pliant::contact
