// Vectors and spatial vectors, one per lane, in world axes about the world's origin (Featherstone's conventions,
// linear part first), and the same for single scalars.
#pragma once
#include "simd.hpp"

namespace pliant::mpc::PLIANT_ISA {

struct Vec {
  double x, y, z;
};
PLIANT_INLINE Vec operator+(const Vec& a, const Vec& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
PLIANT_INLINE Vec operator-(const Vec& a, const Vec& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
PLIANT_INLINE Vec operator-(const Vec& a) { return {-a.x, -a.y, -a.z}; }
PLIANT_INLINE Vec operator*(const Vec& a, double s) { return {a.x * s, a.y * s, a.z * s}; }
PLIANT_INLINE Vec cross(const Vec& a, const Vec& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
PLIANT_INLINE double dot(const Vec& a, const Vec& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
PLIANT_INLINE Vec vec(const double* p) { return {p[0], p[1], p[2]}; }

struct Mat {
  double m[9];  // row-major
  PLIANT_INLINE Vec row(int i) const { return {m[3 * i], m[3 * i + 1], m[3 * i + 2]}; }
  PLIANT_INLINE Vec col(int j) const { return {m[j], m[3 + j], m[6 + j]}; }
};
PLIANT_INLINE Mat mat(const double* p) { return {{p[0], p[1], p[2], p[3], p[4], p[5], p[6], p[7], p[8]}}; }
PLIANT_INLINE bool is_identity(const Mat& A) {
  for (int i = 0; i < 9; ++i)
    if (A.m[i] != (i % 4 == 0)) return false;
  return true;
}
PLIANT_INLINE Vec operator*(const Mat& A, const Vec& v) {
  return {dot(A.row(0), v), dot(A.row(1), v), dot(A.row(2), v)};
}
PLIANT_INLINE Mat operator*(const Mat& A, const Mat& B) {
  Mat C;
#pragma GCC unroll 3
  for (int i = 0; i < 3; ++i)
#pragma GCC unroll 3
    for (int j = 0; j < 3; ++j) C.m[3 * i + j] = dot(A.row(i), B.col(j));
  return C;
}
PLIANT_INLINE Mat transposed(const Mat& A) {
  return {{A.m[0], A.m[3], A.m[6], A.m[1], A.m[4], A.m[7], A.m[2], A.m[5], A.m[8]}};
}

// One 3-vector per lane.
struct Vecs {
  Lanes x, y, z;
};
PLIANT_INLINE Vecs splat(const Vec& a) { return {splat(a.x), splat(a.y), splat(a.z)}; }
PLIANT_INLINE Vec lane(const Vecs& a, int i) { return {a.x[i], a.y[i], a.z[i]}; }
PLIANT_INLINE Vecs operator+(const Vecs& a, const Vecs& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
PLIANT_INLINE Vecs operator-(const Vecs& a, const Vecs& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
PLIANT_INLINE Vecs operator*(const Vecs& a, const Lanes& s) { return {a.x * s, a.y * s, a.z * s}; }
PLIANT_INLINE Vecs operator*(const Vecs& a, double s) { return {a.x * s, a.y * s, a.z * s}; }
PLIANT_INLINE Vecs cross(const Vecs& a, const Vecs& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
PLIANT_INLINE Vecs cross(const Vecs& a, const Vec& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
PLIANT_INLINE Vecs cross(const Vec& a, const Vecs& b) {
  return {b.z * a.y - b.y * a.z, b.x * a.z - b.z * a.x, b.y * a.x - b.x * a.y};
}
PLIANT_INLINE Lanes dot(const Vecs& a, const Vecs& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
PLIANT_INLINE Lanes dot(const Vecs& a, const Vec& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
PLIANT_INLINE Vecs operator*(const Mat& A, const Vecs& v) {
  return {dot(v, A.row(0)), dot(v, A.row(1)), dot(v, A.row(2))};
}

// Running sums of every member of a struct made of Lanes; a loop, so that the code stays small.
template <class T>
PLIANT_INLINE void sum_outward(const T& a, T& sums) {
  const Lanes* from = reinterpret_cast<const Lanes*>(&a);
  Lanes* to = reinterpret_cast<Lanes*>(&sums);
#pragma GCC unroll 1
  for (unsigned i = 0; i < sizeof(T) / sizeof(Lanes); ++i) to[i] = sum_outward(from[i]);
}
template <class T>
PLIANT_INLINE T sum_outward(const T& a) {
  T sums;
  sum_outward(a, sums);
  return sums;
}
template <class T>
PLIANT_INLINE void sum_inward(const T& a, T& sums) {
  const Lanes* from = reinterpret_cast<const Lanes*>(&a);
  Lanes* to = reinterpret_cast<Lanes*>(&sums);
#pragma GCC unroll 1
  for (unsigned i = 0; i < sizeof(T) / sizeof(Lanes); ++i) to[i] = sum_inward(from[i]);
}

// A motion (velocity, acceleration) or a force (force, moment about the origin) per lane.
struct Spatial {
  Vecs lin, ang;
};
struct SpatialVec {
  Vec lin, ang;
};
PLIANT_INLINE Spatial splat(const SpatialVec& a) { return {splat(a.lin), splat(a.ang)}; }
PLIANT_INLINE SpatialVec lane(const Spatial& a, int i) { return {lane(a.lin, i), lane(a.ang, i)}; }
PLIANT_INLINE Spatial operator+(const Spatial& a, const Spatial& b) { return {a.lin + b.lin, a.ang + b.ang}; }
PLIANT_INLINE Spatial operator-(const Spatial& a, const Spatial& b) { return {a.lin - b.lin, a.ang - b.ang}; }
PLIANT_INLINE Spatial operator*(const Spatial& a, const Lanes& s) { return {a.lin * s, a.ang * s}; }
PLIANT_INLINE Spatial operator*(const Spatial& a, double s) { return {a.lin * s, a.ang * s}; }
PLIANT_INLINE Lanes dot(const Spatial& a, const Spatial& b) { return dot(a.lin, b.lin) + dot(a.ang, b.ang); }
PLIANT_INLINE Lanes dot(const Spatial& a, const SpatialVec& b) { return dot(a.lin, b.lin) + dot(a.ang, b.ang); }
PLIANT_INLINE Spatial parent(const Spatial& a) {  // the value of the joint before, zero for the first
  return {{shift_up<1>(a.lin.x), shift_up<1>(a.lin.y), shift_up<1>(a.lin.z)},
          {shift_up<1>(a.ang.x), shift_up<1>(a.ang.y), shift_up<1>(a.ang.z)}};
}
// m × m' of motions and m ×* f of a motion and a force.
PLIANT_INLINE Spatial cross_motion(const Spatial& a, const Spatial& b) {
  return {cross(a.ang, b.lin) + cross(a.lin, b.ang), cross(a.ang, b.ang)};
}
PLIANT_INLINE Spatial cross_motion(const SpatialVec& a, const Spatial& b) {
  return {cross(a.ang, b.lin) + cross(a.lin, b.ang), cross(a.ang, b.ang)};
}
PLIANT_INLINE Spatial cross_force(const Spatial& m, const Spatial& f) {
  return {cross(m.ang, f.lin), cross(m.lin, f.lin) + cross(m.ang, f.ang)};
}

// Symmetric 3×3 matrix per lane.
struct Sym {
  Lanes xx, xy, xz, yy, yz, zz;
};
PLIANT_INLINE Vecs operator*(const Sym& A, const Vecs& v) {
  return {A.xx * v.x + A.xy * v.y + A.xz * v.z, A.xy * v.x + A.yy * v.y + A.yz * v.z,
          A.xz * v.x + A.yz * v.y + A.zz * v.z};
}

// Rigid-body inertia about the world's origin: mass, first moment m c, rotational part.
struct Inertia {
  Lanes mass;
  Vecs moment;
  Sym rotational;
};
PLIANT_INLINE Spatial operator*(const Inertia& Y, const Spatial& v) {
  return {v.lin * Y.mass - cross(Y.moment, v.ang), cross(Y.moment, v.lin) + Y.rotational * v.ang};
}

}  // namespace pliant::mpc::PLIANT_ISA
