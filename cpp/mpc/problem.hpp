// Plain data that crosses the border between the instruction-set copies and the binding.
// No inline function may live here: it would be shared code compiled for different instruction sets.
#pragma once

namespace pliant::mpc {

constexpr int max_joints = 8;
constexpr int max_contact = 6;
constexpr int multipliers_per_node = max_joints + max_contact + 3;

enum class Kind { force_feedback, classical, torque_feedback, free, naive_viscoelastic };
enum class Axes { local, world, surface };
enum class Integrator { euler, exponential };
enum class Status { converged, max_iterations, time_budget, line_search, not_positive_definite, nan };

// 3×3 matrices are row-major; see _mpc.pyi for the meaning and unit of every quantity.
struct ChainData {
  int dof;
  bool prismatic[max_joints];
  double rotation[max_joints][9], translation[max_joints][3], axis[max_joints][3];
  double mass[max_joints], com[max_joints][3], inertia[max_joints][9];
  double rotor_inertia[max_joints], joint_damping[max_joints];
  double gravity[3];
  double tool_rotation[9], tool_translation[3];
  double contact_rotation[9], contact_translation[3];
};

struct ModelData {
  Kind kind;
  int contact_dim;
  Axes axes;
  Integrator integrator;
  double torque_bandwidth;    // [Hz]
  double baumgarte_position;  // [1/s²]
  double baumgarte_velocity;  // [1/s]
};

struct NodeData {
  double state_reference[2 * max_joints], state_weight[2 * max_joints];
  double control_reference[max_joints], control_weight[max_joints];
  double torque_gravity_weight[max_joints], control_gravity_weight[max_joints];
  double task_rotation[9];  // R_world_task
  double translation_reference[3], translation_weight[3];
  double rotation_reference[9], rotation_weight[3];
  double velocity_reference[6], velocity_weight[6];
  double force_reference[max_contact], force_weight[max_contact], force_rate_weight[max_contact];
  double stiffness[max_contact], damping[max_contact];
  double anchor_translation[3], anchor_rotation[9];
  double torque_lower[max_joints], torque_upper[max_joints];
  double force_lower[max_contact], force_upper[max_contact];
  double friction;          // of the cone on the force
  double sliding_friction;  // of the predicted contact
  bool contact_active;
};

struct Options {
  int horizon;
  double dt;  // [s]
  double regularisation;
  int filter_size, line_search_steps;
  bool bounds;
};

struct Limits {
  int max_iterations;
  double tolerance;
  double time_budget;  // [s], negative: none
};

struct Report {
  Status status;
  int iterations, evaluations, factorisations;
  double kkt, cost, gap, violation, seconds;
};

// Dense row-major outputs of one node; null pointers are skipped.
struct NodeOutput {
  double cost;
  double *x_next, *acceleration, *force, *force_rate;
  double *fx, *fu, *Lx, *Lu, *Lxx, *Lxu, *Luu, *force_x, *force_u;
};

struct Engine;  // opaque: a solver of one instruction set, joint count and state layout

// What one copy offers.
struct KernelTable {
  Engine* (*create)(const ChainData&, const ModelData&, const Options&);
  void (*destroy)(Engine*);
  // One node of the engine, dense; `derivatives` false fills only the values.
  void (*node)(Engine*, const NodeData&, bool terminal, bool derivatives, const double* x, const double* u,
               NodeOutput&);
  double (*time_node)(Engine*, const NodeData&, bool terminal, bool derivatives, const double* x, const double* u,
                      int repetitions);
  void (*freeze)(Engine*, const double* task_rotation, const double* q);
  void (*set_plan)(Engine*, const double* xs, const double* us);
  void (*get_plan)(const Engine*, double* xs, double* us);
  void (*shift)(Engine*);
  void (*reset)(Engine*);
  void (*quasi_static)(Engine*, const NodeData*, const double* x0);
  void (*solve)(Engine*, const NodeData*, const double* x0, const Limits&, Report&);
  void (*get_feedback)(const Engine*, double* gain, double* forces);  // either may be null
  // Of the bounds, `multipliers_per_node` numbers for each of the N + 1 nodes; nothing where bounds are ignored.
  void (*get_multipliers)(const Engine*, double* multipliers);
  void (*set_multipliers)(Engine*, const double* multipliers);
  void (*tool_path)(const Engine*, double* positions);  // (N+1, 3) of the plan [m]
  void (*gravity)(const ChainData&, const double* q, double* torque);
  void (*mass_matrix)(const ChainData&, const double* q, double* M);
  void (*placement)(const ChainData&, bool contact, const double* q, double* R, double* p);
};

}  // namespace pliant::mpc
