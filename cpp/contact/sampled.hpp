// A mesh seen through the samples of its distance: smooth within a band round it, its triangles farther away.
#pragma once

#include "field.hpp"
#include "mesh.hpp"

namespace pliant::contact {

// Distance and outward unit normal at a point: from the samples up to `band` m off, else from the triangles.
inline MeshPlace seen(const Mesh& mesh, const Field& field, double band, const Vec3& point) {
  constexpr double kFlat = 0.1;   // of a gradient, whose length is 1 but on ridges far from the mesh
  constexpr double kTiny = 1e-9;  // m
  const Distance sampled = field.at(point);
  const double length = norm(sampled.gradient);
  if (sampled.known && length > kFlat && std::fabs(sampled.value) < band)
    return {sampled.value, {}, (1.0 / length) * sampled.gradient};
  MeshPlace far = mesh.nearest(point);
  if (std::fabs(far.distance) > kTiny) far.normal = (1.0 / far.distance) * (point - far.point);
  return far;
}

// The same with the place of the smooth surface that is nearest, and the normal there.
inline MeshPlace nearest(const Mesh& mesh, const Field& field, double band, const Vec3& point) {
  constexpr int kSteps = 4;  // farther out the triangles point the way; near it each step squares what is left
  MeshPlace here = seen(mesh, field, band, point);
  const double distance = here.distance;
  Vec3 place = point;
  for (int i = 0; i < kSteps; ++i) {
    place = place - here.distance * here.normal;
    here = seen(mesh, field, band, place);
  }
  return {distance, place, here.normal};
}

}  // namespace pliant::contact
