#include "tree.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace pliant::bodies {
namespace {

void multiply(const double* A, const double* B, double* out) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) out[3 * i + j] = A[3 * i] * B[j] + A[3 * i + 1] * B[3 + j] + A[3 * i + 2] * B[6 + j];
}

// Rodrigues, about an axis of unit length.
void turn(const Vec3& axis, double angle, double* R) {
  const double c = std::cos(angle), s = std::sin(angle);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) R[3 * i + j] = (1 - c) * axis[i] * axis[j] + (i == j ? c : 0);
  R[1] -= s * axis.z, R[2] += s * axis.y, R[3] += s * axis.z;
  R[5] -= s * axis.x, R[6] -= s * axis.y, R[7] += s * axis.x;
}

Vec3 times(const double* A, const Vec3& x) {
  return {A[0] * x.x + A[1] * x.y + A[2] * x.z, A[3] * x.x + A[4] * x.y + A[5] * x.z,
          A[6] * x.x + A[7] * x.y + A[8] * x.z};
}

// I x of an inertia (3, 3) in local axes and a vector in world axes.
Vec3 turned(const double* inertia, const Rotation& R, const Vec3& x) {
  return R.to_world(times(inertia, R.to_local(x)));
}

const Body still = {{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {}}, {}, {}, {}, {}};

// The pose of what is fixed to a body at a placement. Returns the way to it from the body's origin.
Vec3 place(const Pose& carrier, const Pose& placement, Pose& found) {
  multiply(carrier.R, placement.R, found.R);
  const Vec3 lever = carrier.rotation().to_world(placement.p);
  found.p = carrier.p + lever;
  return lever;
}

// Turns a pose about an axis of its own.
void turn(const Vec3& axis, double angle, Pose& pose) {
  double local[9], fixed[9];
  turn(axis, angle, local);
  std::copy(pose.R, pose.R + 9, fixed);
  multiply(fixed, local, pose.R);
}

// What is fixed to a body at a placement.
Body fixed_to(const Body& carrier, const Pose& placement) {
  Body b;
  const Vec3 lever = place(carrier.pose, placement, b.pose);
  b.spin = carrier.spin;
  b.spinning = carrier.spinning;
  b.velocity = carrier.velocity + cross(carrier.spin, lever);
  b.acceleration =
      carrier.acceleration + cross(carrier.spinning, lever) + cross(carrier.spin, cross(carrier.spin, lever));
  return b;
}

// Momentum about the world's origin of a body that moves so.
Screw momentum_of(const Joint& joint, const Body& b, const Vec3& spin, const Vec3& velocity) {
  const Rotation R = b.pose.rotation();
  const Vec3 lever = R.to_world(joint.center);
  const Vec3 linear = joint.mass * (velocity + cross(spin, lever));
  return {linear, cross(b.pose.p + lever, linear) + turned(joint.inertia, R, spin)};
}

}  // namespace

Tree::Tree(std::vector<Joint> joints, std::vector<Frame> frames, Vec3 gravity)
    : joints_(std::move(joints)), frames_(std::move(frames)), gravity_(gravity) {
  for (int i = 0; i < n(); ++i)
    if (joints_[size_t(i)].parent < -1 || joints_[size_t(i)].parent >= i)
      throw std::invalid_argument("a joint's parent must come before it");
  for (const Frame& frame : frames_)
    if (frame.joint < -1 || frame.joint >= n())
      throw std::invalid_argument("frame '" + frame.name + "' must be carried by a joint of the robot");
}

const Frame& Tree::frame(const std::string& name) const {
  for (const Frame& frame : frames_)
    if (frame.name == name) return frame;
  throw std::invalid_argument("no frame '" + name + "'");
}

void Tree::move(const double* q, const double* v, const double* a, Body* bodies) const {
  for (int i = 0; i < n(); ++i) {
    const Joint& joint = joints_[size_t(i)];
    const double rate = v ? v[i] : 0, push = a ? a[i] : 0;
    Body& b = bodies[i];
    b = fixed_to(joint.parent < 0 ? still : bodies[joint.parent], joint.placement);
    const Vec3 axis = b.pose.rotation().to_world(joint.axis);
    if (joint.prismatic) {
      const Vec3 slide = q[i] * axis;
      b.pose.p = b.pose.p + slide;
      b.velocity = b.velocity + cross(b.spin, slide) + rate * axis;
      b.acceleration = b.acceleration + cross(b.spinning, slide) + cross(b.spin, cross(b.spin, slide)) +
                       2 * rate * cross(b.spin, axis) + push * axis;
    } else {
      turn(joint.axis, q[i], b.pose);
      b.spinning = b.spinning + push * axis + rate * cross(b.spin, axis);
      b.spin = b.spin + rate * axis;
    }
  }
}

void Tree::place(const double* q, Body* bodies) const {
  for (int i = 0; i < n(); ++i) {
    const Joint& joint = joints_[size_t(i)];
    Pose& pose = bodies[i].pose;
    pliant::bodies::place((joint.parent < 0 ? still : bodies[joint.parent]).pose, joint.placement, pose);
    if (joint.prismatic) {
      pose.p = pose.p + q[i] * pose.rotation().to_world(joint.axis);
    } else {
      turn(joint.axis, q[i], pose);
    }
  }
}

Pose Tree::pose_of(const Frame& frame, const Body* bodies) const {
  Pose found;
  pliant::bodies::place((frame.joint < 0 ? still : bodies[frame.joint]).pose, frame.placement, found);
  return found;
}

Body Tree::at(const Frame& frame, const Body* bodies) const {
  return fixed_to(frame.joint < 0 ? still : bodies[frame.joint], frame.placement);
}

Screw Tree::motion(int joint, const Body& body) const {
  const Vec3 axis = body.pose.rotation().to_world(joints_[size_t(joint)].axis);
  if (joints_[size_t(joint)].prismatic) return {axis, {}};
  return {cross(body.pose.p, axis), axis};
}

void Tree::gather(Screw* of_bodies) const {
  for (int i = n() - 1; i >= 0; --i)
    if (const int parent = joints_[size_t(i)].parent; parent >= 0) of_bodies[parent] = of_bodies[parent] + of_bodies[i];
}

void Tree::momentum(const double* v, const Body* bodies, Compensation compensation, Screw* scratch, double* p,
                    double* beta) const {
  for (int i = 0; i < n(); ++i)
    scratch[i] = momentum_of(joints_[size_t(i)], bodies[i], bodies[i].spin, bodies[i].velocity);
  gather(scratch);
  for (int i = 0; i < n(); ++i) {
    const Body& b = bodies[i];
    const Screw S = motion(i, b), V = {b.velocity - cross(b.spin, b.pose.p), b.spin};
    const Screw crossed = {cross(V.angular, S.linear) + cross(V.linear, S.angular), cross(V.angular, S.angular)};
    p[i] = dot(S, scratch[i]) + joints_[size_t(i)].rotor * v[i];
    beta[i] = dot(crossed, scratch[i]);
  }
  if (compensation == Compensation::gravity) return;
  for (int i = 0; i < n(); ++i) {  // the force that each body lacks: −m g, or what turns its momentum
    const Joint& joint = joints_[size_t(i)];
    const Body& b = bodies[i];
    const Vec3 lever = b.pose.rotation().to_world(joint.center), center = b.pose.p + lever;
    if (compensation == Compensation::none) {
      const Vec3 weight = joint.mass * gravity_;
      scratch[i] = {weight, cross(center, weight)};
    } else {
      const Vec3 spun = turned(joint.inertia, b.pose.rotation(), b.spin);
      scratch[i] = momentum_of(joint, b, b.spinning, b.acceleration + cross(b.spin, cross(b.spin, lever)));
      scratch[i].angular = scratch[i].angular + cross(b.spin, spun);
    }
  }
  gather(scratch);
  for (int i = 0; i < n(); ++i) beta[i] += dot(motion(i, bodies[i]), scratch[i]);
}

void Tree::add_torque(const Frame& frame, const Body* bodies, const Vec3& force, const Vec3& moment,
                      double* torque) const {
  const Vec3 p = at(frame, bodies).pose.p;
  const Screw wrench = {force, cross(p, force) + moment};
  for (int i = frame.joint; i >= 0; i = joints_[size_t(i)].parent) torque[i] += dot(motion(i, bodies[i]), wrench);
}

}  // namespace pliant::bodies
