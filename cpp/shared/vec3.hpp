// Three-vectors and rotation matrices, only as much as contacts and estimators need.
#pragma once

#include <cmath>

namespace pliant {

struct Vec3 {
  double x = 0.0, y = 0.0, z = 0.0;

  double& operator[](int i) { return i == 0 ? x : (i == 1 ? y : z); }
  double operator[](int i) const { return i == 0 ? x : (i == 1 ? y : z); }
};

inline Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vec3 operator-(const Vec3& a) { return {-a.x, -a.y, -a.z}; }
inline Vec3 operator*(double s, const Vec3& a) { return {s * a.x, s * a.y, s * a.z}; }
inline double dot(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline double norm(const Vec3& a) { return std::sqrt(dot(a, a)); }
inline Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Vec3 load(const double* p) { return {p[0], p[1], p[2]}; }
inline void store(const Vec3& a, double* p) { p[0] = a.x, p[1] = a.y, p[2] = a.z; }

// A view of a row-major 3×3 rotation R_world_local, as MuJoCo stores it.
struct Rotation {
  const double* m;

  Vec3 column(int j) const { return {m[j], m[3 + j], m[6 + j]}; }
  Vec3 to_world(const Vec3& v) const { return v.x * column(0) + v.y * column(1) + v.z * column(2); }
  Vec3 to_local(const Vec3& v) const { return {dot(column(0), v), dot(column(1), v), dot(column(2), v)}; }
};

}  // namespace pliant
