// The robot in the form the kernel wants: every joint turns about, or slides along, the z axis of its own link frame,
// and the chain is filled up to J joints with joints that have no axis and unit inertia (they never move).
#pragma once
#include "../problem.hpp"
#include "spatial.hpp"

namespace pliant::mpc::PLIANT_ISA {

struct alignas(64) Chain {
  Lanes mass, com_x, com_y, com_z;
  Sym inertia;     // about the centre of mass, in link axes
  Lanes armature;  // rotor inertia; 1 for a filled-up joint
  Lanes joint_damping;
  Lanes is_revolute, is_prismatic;  // 1 or 0; both 0 beyond the robot's joints
  Lanes is_joint;                   // 1 for the J lanes in use, filled-up ones included
  Lanes filler;                     // 1 for filled-up joints
  double revolute[lane_count], prismatic[lane_count];
  Mat rotation[lane_count];
  Vec translation[lane_count];
  Vec gravity;
  Mat tool_rotation, contact_rotation;
  Vec tool_translation, contact_translation;
  int dof;
};

// A rotation whose third column is the given unit axis.
inline Mat frame_with_z(const Vec& axis) {
  const double ax = magnitude(axis.x), ay = magnitude(axis.y), az = magnitude(axis.z);
  const Vec helper = ax <= ay && ax <= az ? Vec{1, 0, 0} : ay <= az ? Vec{0, 1, 0} : Vec{0, 0, 1};
  const Vec y_raw = cross(axis, helper);
  const Vec y = y_raw * (1.0 / sqrt(dot(y_raw, y_raw)));
  const Vec x = cross(y, axis);
  return {{x.x, y.x, axis.x, x.y, y.y, axis.y, x.z, y.z, axis.z}};
}

inline Chain make_chain(const ChainData& data, int joints) {
  const Mat identity = {{1, 0, 0, 0, 1, 0, 0, 0, 1}};
  Chain c{};
  c.dof = data.dof;
  c.gravity = vec(data.gravity);
  Mat previous = identity;  // link axes chosen here, in the user's link axes
  for (int i = 0; i < lane_count; ++i) {
    c.rotation[i] = identity;
    if (i < joints) c.is_joint.set(i, 1);
    if (i >= data.dof) {
      c.armature.set(i, 1);
      if (i < joints) c.filler.set(i, 1);
      continue;
    }
    const Mat own = frame_with_z(vec(data.axis[i]));
    c.rotation[i] = transposed(previous) * (mat(data.rotation[i]) * own);
    c.translation[i] = transposed(previous) * vec(data.translation[i]);
    const Vec com = transposed(own) * vec(data.com[i]);
    const Mat I = transposed(own) * (mat(data.inertia[i]) * own);
    c.mass.set(i, data.mass[i]);
    c.com_x.set(i, com.x);
    c.com_y.set(i, com.y);
    c.com_z.set(i, com.z);
    c.inertia.xx.set(i, I.m[0]);
    c.inertia.xy.set(i, I.m[1]);
    c.inertia.xz.set(i, I.m[2]);
    c.inertia.yy.set(i, I.m[4]);
    c.inertia.yz.set(i, I.m[5]);
    c.inertia.zz.set(i, I.m[8]);
    c.armature.set(i, data.rotor_inertia[i]);
    c.joint_damping.set(i, data.joint_damping[i]);
    c.prismatic[i] = data.prismatic[i] ? 1 : 0;
    c.revolute[i] = 1 - c.prismatic[i];
    c.is_prismatic.set(i, c.prismatic[i]);
    c.is_revolute.set(i, c.revolute[i]);
    previous = own;
  }
  // Filled-up joints keep the last link's axes, so the last lane always carries the last link.
  c.tool_rotation = transposed(previous) * mat(data.tool_rotation);
  c.tool_translation = transposed(previous) * vec(data.tool_translation);
  c.contact_rotation = transposed(previous) * mat(data.contact_rotation);
  c.contact_translation = transposed(previous) * vec(data.contact_translation);
  return c;
}

}  // namespace pliant::mpc::PLIANT_ISA
