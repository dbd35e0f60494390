// Where the links are and how they move; frames on the last link.
#pragma once
#include "chain.hpp"
#include "trigonometry.hpp"

namespace pliant::mpc::PLIANT_ISA {

// One lane per joint, world axes.
struct Kinematics {
  Vecs x_axis, y_axis, z_axis;  // columns of R_world_link
  Vecs origin;                  // of the link frames [m]
  Spatial S;                    // joint axes as motions about the world's origin
};

template <int J>
PLIANT_INLINE void forward_kinematics(const Chain& chain, const Lanes& q, Kinematics& kin) {
  const SinCos angle = sine_cosine(q * chain.is_revolute);
  alignas(64) double entry[12][lane_count];
  Vec x = {1, 0, 0}, y = {0, 1, 0}, z = {0, 0, 1}, p = {0, 0, 0};
#pragma GCC unroll 8
  for (int i = 0; i < J; ++i) {
    const Mat& R = chain.rotation[i];
    const Vec& t = chain.translation[i];
    p = p + x * t.x + y * t.y + z * t.z;
    const Vec bx = x * R.m[0] + y * R.m[3] + z * R.m[6];
    const Vec by = x * R.m[1] + y * R.m[4] + z * R.m[7];
    z = x * R.m[2] + y * R.m[5] + z * R.m[8];
    x = bx * angle.cos[i] + by * angle.sin[i];
    y = by * angle.cos[i] - bx * angle.sin[i];
    p = p + z * (chain.prismatic[i] * q[i]);
    const double entries[12] = {x.x, x.y, x.z, y.x, y.y, y.z, z.x, z.y, z.z, p.x, p.y, p.z};
#pragma GCC unroll 12
    for (int r = 0; r < 12; ++r) entry[r][i] = entries[r];
  }
#pragma GCC unroll 12
  for (int r = 0; r < 12; ++r)
    for (int i = J; i < lane_count; ++i) entry[r][i] = 0;
  kin.x_axis = {load(entry[0]), load(entry[1]), load(entry[2])};
  kin.y_axis = {load(entry[3]), load(entry[4]), load(entry[5])};
  kin.z_axis = {load(entry[6]), load(entry[7]), load(entry[8])};
  kin.origin = {load(entry[9]), load(entry[10]), load(entry[11])};
  const Vecs turning = kin.z_axis * chain.is_revolute;
  kin.S = {cross(kin.origin, turning) + kin.z_axis * chain.is_prismatic, turning};
}

// A frame on the last link.
struct Frame {
  Mat R;
  Vec p;
};

template <int J>
PLIANT_INLINE Frame frame_on_last_link(const Kinematics& kin, const Mat& rotation, const Vec& translation) {
  const Vec x = lane(kin.x_axis, J - 1), y = lane(kin.y_axis, J - 1), z = lane(kin.z_axis, J - 1);
  const Mat link = {{x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z}};
  return {link * rotation, link * translation + lane(kin.origin, J - 1)};
}

// Velocities and the rates of the joint axes.
struct Velocities {
  Spatial link;       // v_j
  Spatial parent;     // v of the link before
  Spatial axis_rate;  // v_j × S_j = dS_j/dt
  SpatialVec last;    // of the last link
};

template <int J>
PLIANT_INLINE void velocities(const Kinematics& kin, const Lanes& qd, Velocities& v) {
  sum_inward(kin.S * qd, v.link);
  v.parent = parent(v.link);
  v.axis_rate = cross_motion(v.link, kin.S);
  v.last = lane(v.link, J - 1);
}

// A motion about the world's origin, seen at a point: linear part of the point, angular part.
PLIANT_INLINE Spatial at_point(const Spatial& m, const Vec& p) { return {m.lin + cross(m.ang, p), m.ang}; }
PLIANT_INLINE SpatialVec at_point(const SpatialVec& m, const Vec& p) { return {m.lin + cross(m.ang, p), m.ang}; }

}  // namespace pliant::mpc::PLIANT_ISA
