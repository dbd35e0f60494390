// All contacts of a scene, and the loop that alternates them with a physics engine's half steps.
#pragma once

#include <cstdint>
#include <vector>

#include "graded.hpp"
#include "law.hpp"
#include "shapes.hpp"
#include "tool.hpp"

namespace pliant::contact {

struct Pair {
  int geom_a, geom_b;
  Graded material;
  bool hollow;       // geom_b's material is outside of it
  const Form* form;  // geom_b's surface, in its axes; null: its own shape
  bool tool;         // geom_a's points share the material
  int first_slot, slots;
};

// Views of a MuJoCo model and its data. Nothing here owns memory.
struct Views {
  const int32_t* geom_type;      // (ngeom,)
  const int32_t* geom_body;      // (ngeom,)
  const double* geom_size;       // (ngeom, 3)
  const double* geom_position;   // (ngeom, 3)
  const double* geom_rotation;   // (ngeom, 9)
  const int32_t* body_root;      // (nbody,)
  const double* body_com;        // (nbody, 3) where xfrc_applied acts
  const double* subtree_com;     // (nbody, 3) where cvel is expressed
  const double* body_velocity;   // (nbody, 6) cvel: angular first
  double* body_force;            // (nbody, 6) xfrc_applied: force, then torque
  const double* joint_velocity;  // (nv,)
  int ngeom, nbody, nv;
};

// Where the forces of one evaluation go, one row per contact point.
struct Output {
  double* force;        // (slots, 3) N on body A, world axes
  double* point;        // (slots, 3) m, world
  double* penetration;  // (slots,) m
};

using HalfStep = void (*)(const void* model, void* data);

class World {
 public:
  // Returns the first slot of the pair, or -1 if the shapes are not supported in this order. Args: form: the surface
  // of geom_b, which must live as long as the world; null: its own shape. tool: geom_a is a cylinder or a box whose
  // points share the material.
  int add_pair(const Views& views, int geom_a, int geom_b, const Graded& material, bool hollow,
               const Form* form = nullptr, bool tool = false);
  int slots() const { return slots_; }
  const std::vector<Pair>& pairs() const { return pairs_; }

  // One evaluation: writes push plus contact forces to body_force. With dt = 0 the bristles keep their state.
  // Returns false if a force is absurd or not finite.
  bool evaluate(const Views& views, double dt, const double* push, double* bristles, const Output& out) const;

  // `count` steps of dt. Returns how many were completed: fewer than `count` if a force or a velocity is absurd or not
  // finite.
  int advance(const Views& views, HalfStep step1, HalfStep step2, const void* model, void* data, int count, double dt,
              const double* push, double* bristles, const Output& out) const;

 private:
  std::vector<Pair> pairs_;
  int slots_ = 0;
};

}  // namespace pliant::contact
