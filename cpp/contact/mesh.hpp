// A surface of triangles: the place nearest to a point, on which side the point is, and the normal there.
#pragma once

#include <cstdint>
#include <vector>

#include "../shared/vec3.hpp"

namespace pliant::contact {

struct MeshPlace {
  double distance;  // m, negative inside
  Vec3 point;       // m, nearest on the mesh
  Vec3 normal;      // outward: of the face, or the mean over the faces round an edge or a corner, by angle
};

// Triangles that share corners, all seen the same way round from outside. A point whose nearest place is on an edge of
// one triangle alone (the rim of an open shell) is outside: beyond a rim there is no material.
// The side is that of the angle-weighted normal (Baerentzen and Aanaes 2005); tests compare it with the winding number
// of drawn closed meshes.
class Mesh {
 public:
  // vertices (nv, 3) m; triangles (nt, 3), every index below nv; no triangle without area.
  Mesh(const double* vertices, int vertex_count, const int32_t* triangles, int triangle_count);

  MeshPlace nearest(const Vec3& point) const;
  int triangle_count() const { return static_cast<int>(triangles_.size()); }

 private:
  struct Triangle {
    int corner[3];
    Vec3 normal;
    Vec3 edge_normal[3];  // opposite to corner i; sum over the two faces
    bool rim[3];
  };
  struct Node {  // of a tree of boxes; a leaf where count > 0
    Vec3 low, high;
    int first, count;  // leaf: triangles; else: first child, the second is next to it
  };

  void connect();
  void split(int node, int first, int count, int depth);
  void closer(const Triangle& triangle, const Vec3& point, double& best2, MeshPlace& found) const;

  std::vector<Vec3> vertices_, vertex_normal_;
  std::vector<bool> vertex_rim_;
  std::vector<Triangle> triangles_;
  std::vector<int> order_;
  std::vector<Node> nodes_;
};

}  // namespace pliant::contact
