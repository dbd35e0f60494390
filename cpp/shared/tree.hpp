// Rigid bodies on a fixed base, joined by joints of one degree of freedom: where they are, how they move, and the terms
// of their generalised momentum. Everything is in world axes; a motion or a force about the world's origin has its
// linear part first.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "vec3.hpp"

namespace pliant::bodies {

struct Pose {
  double R[9];  // row by row, R_world_local
  Vec3 p;       // [m]

  Rotation rotation() const { return {R}; }
};

struct Joint {
  int parent;      // index of the joint before it; -1: the world
  Pose placement;  // in the parent's frame
  Vec3 axis;       // of unit length, in its own frame
  bool prismatic;
  double mass;        // of the body that it moves [kg]
  Vec3 center;        // of it, in the joint's frame [m]
  double inertia[9];  // about that centre, in the joint's axes [kg m²]
  double rotor;       // as the joint feels it [kg m²]
};

struct Frame {
  std::string name;
  int joint;  // that carries it; -1: the world
  Pose placement;
};

// A velocity or an acceleration of a body, or a force on it, about the world's origin.
struct Screw {
  Vec3 linear, angular;
};
inline Screw operator+(const Screw& a, const Screw& b) { return {a.linear + b.linear, a.angular + b.angular}; }
inline Screw operator*(double s, const Screw& a) { return {s * a.linear, s * a.angular}; }
inline double dot(const Screw& a, const Screw& b) { return dot(a.linear, b.linear) + dot(a.angular, b.angular); }

// How a body is placed and moves. Acceleration is that of its points at rest in the body: ω × v is part of it.
struct Body {
  Pose pose;
  Vec3 velocity, spin;          // of the frame's origin [m/s], [rad/s]
  Vec3 acceleration, spinning;  // of the frame's origin, gravity not taken off [m/s²], [rad/s²]
};

// How much of the torque that moves the bodies the robot's own controller sends.
enum class Compensation { none, gravity, gravity_and_coriolis };

class Tree {
 public:
  // Throws std::invalid_argument: a joint before its parent, a frame of a joint that there is not.
  Tree(std::vector<Joint> joints, std::vector<Frame> frames, Vec3 gravity);

  int n() const { return int(joints_.size()); }
  const Vec3& gravity() const { return gravity_; }
  // Throws std::invalid_argument: no frame of this name.
  const Frame& frame(const std::string& name) const;

  // Bodies (n) at q; v and a may be null, for zero.
  void move(const double* q, const double* v, const double* a, Body* bodies) const;
  // The same of poses alone: what moves is left as it was.
  void place(const double* q, Body* bodies) const;
  Pose pose_of(const Frame& frame, const Body* bodies) const;
  Body at(const Frame& frame, const Body* bodies) const;
  // Motion of a joint at unit rate, of a body that it moves.
  Screw motion(int joint, const Body& body) const;

  // Momentum p = M v (n) and what the model adds to ṗ beside the torque sent, β = Cᵀ v − g (n), with what is
  // compensated taken off. `bodies` at q and v with a = 0; `scratch` (n).
  //
  // With S_i the motion of joint i, V_i the twist of its body and H_i the momentum of all bodies behind it:
  // p_i = S_i·H_i, and (Cᵀ v)_i = ∂(½ vᵀ M v)/∂q_i = H_i·(V_i × S_i).
  void momentum(const double* v, const Body* bodies, Compensation compensation, Screw* scratch, double* p,
                double* beta) const;
  // Adds Jᵀ λ (n) of a force and a moment at a frame.
  void add_torque(const Frame& frame, const Body* bodies, const Vec3& force, const Vec3& moment, double* torque) const;

 private:
  std::vector<Joint> joints_;
  std::vector<Frame> frames_;
  Vec3 gravity_;

  // Gives to every joint what all bodies behind it have together.
  void gather(Screw* of_bodies) const;
};

}  // namespace pliant::bodies
