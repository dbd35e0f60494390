// A control period of a simulated robot with perfect sensors in MuJoCo: a torque held over a few physics steps, contact
// wrenches and sensor readings at the end.
#pragma once
#include <mujoco/mujoco.h>

#include <cstdint>
#include <vector>

namespace pliant::plant {

// Functions of the library that the mujoco package has loaded.
struct Library {
  decltype(&mj_step1) step1;
  decltype(&mj_step2) step2;
  decltype(&mj_contactForce) contact_force;
  decltype(&mj_applyFT) apply_force;
  decltype(&mj_rnePostConstraint) accelerations;
  decltype(&mj_objectAcceleration) acceleration;
  decltype(&mj_objectVelocity) velocity;
};

struct Sensor {
  int site = 0;
  double mass = 0;         // [kg] that it carries
  double center[3] = {};   // [m] in its axes
  double inertia[9] = {};  // [kg m2] about that centre
  std::vector<int> felt;   // contact frames beyond it
};

// A force on a site's origin for a while.
struct Push {
  int site;
  double force[3];     // [N]
  double start, stop;  // [s]
};

struct World {
  int n = 0, substeps = 1;
  bool coriolis = false;           // whether the robot compensates its bias forces at every step
  std::vector<double> limit;       // (n) [Nm]
  std::vector<double> fastest;     // (n) [rad/s], beyond which a period ends as failed
  std::vector<int> frame_of_geom;  // contact frame of each geom, -1: none
  std::vector<int> frame_site;     // site of each contact frame
  std::vector<int> frame_of_slot;  // contact frame of each explicit contact, -1: none
  std::vector<Sensor> sensors;
};

// Explicit contacts, (slots, 3) each: force on the robot [N] and where it acts [m], world axes.
struct Contacts {
  const double *force, *point;
};

// Where results go: (n) q, v, torque; (frames, 6); (sensors, 6).
struct Outcome {
  double *q, *v, *torque, *contacts, *readings;
};

class Physics {
 public:
  Physics(World world, const Library& library, const mjModel* model);

  const World& world() const { return world_; }
  int outcome_size() const;
  Outcome outcome(double* row) const;

  // Whether every joint's speed is finite and allowed at the end. `touching`: bit per contact frame.
  bool step(mjData* data, const double* torque, const std::vector<Push>& pushes, Outcome out,
            std::uint64_t& touching) const;
  // The two ends of a period whose steps are made elsewhere: a torque is held from now on; what came of it.
  void hold(mjData* data, const double* torque, const std::vector<Push>& pushes, Outcome out) const;
  bool read(mjData* data, Contacts contacts, Outcome out, std::uint64_t& touching) const;

 private:
  void limit(const double* torque, double* limited) const;
  bool read_robot(mjData* data, Outcome out) const;
  void apply(mjData* data, const double* torque, const std::vector<Push>& pushes) const;
  void read_contacts(mjData* data, double* contacts, std::uint64_t& touching) const;
  void read_sensor(mjData* data, const Sensor& sensor, const double* contacts, double* reading) const;
  void add_carried(mjData* data, const Sensor& sensor, double* reading) const;

  World world_;
  Library library_;
  const mjModel* model_;
};

}  // namespace pliant::plant
