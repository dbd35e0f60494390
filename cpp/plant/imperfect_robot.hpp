// An imperfect robot round a perfect one: late and noisy sensors, drives, gears, computation time. All that changes
// stands in one row of numbers, the memory. Sources: [FFMPC] eq. 30-33, sec. VIII-C; [HapFIC] sec. III.
#pragma once
#include <vector>

namespace pliant::plant {

// From motor torque to torque at the link side: a F(tau) + b - mu_s tanh(v / v_0) - mu_v v + noise.
struct Gears {
  std::vector<double> limit, dry, viscous, noise;  // (n) [Nm], [Nm], [Nm s/rad], [Nm]
  double friction_velocity = 0.1;                  // v_0 [rad/s]
  double kept = 0;                                 // share of the last torque that the first-order lag keeps
};

// tau_m = tau_d - K_P e - K_I int e - K_D d(tau)/dt, e = tau - tau_d.
struct TorqueLoop {
  double period = 0, gain_p = 0, gain_i = 0, gain_d = 0;  // [s], [1], [1/s], [s]
};

// Wrenches times 1 + share sin(phase); both grow with the speed of the joints.
struct Ripple {
  double amplitude = 0, frequency = 0, speed = 1, force = 1;  // [N], [Hz], [rad/s], [N]
};

struct Sensors {
  int late = 0, late_torque = 0, late_force = 0;  // periods of the torque loop; the last comes on top
  std::vector<double> q, v, torque;               // (n) standard deviations
  double wrench[2] = {0, 0};                      // of force [N] and moment [Nm]
};

struct Settings {
  int n = 0, frames = 0;  // joints; force/torque sensors
  int ticks = 1;          // corrections of the torque loop in a control period
  int inner = 1;          // steps of the perfect robot in each
  int under_way = 0;      // corrections from command to effect
  Gears gears;
  TorqueLoop loop;
  Ripple ripple;
  Sensors sensors;
};

// What perfect sensors say: (n), (n), (n), (frames, 6).
struct True {
  const double *q, *v, *torque, *wrenches;
};

// What the sensors say.
struct Reading {
  double *q, *v, *torque, *wrenches;
};

// What is drawn once a run, each (n): gain and bias of the gears, gain and offset of the torque sensors.
struct Drawn {
  const double *gain, *bias, *sensor_gain, *sensor_offset;
};

class ImperfectRobot {
 public:
  explicit ImperfectRobot(Settings settings);

  int memory_size() const { return size_; }
  // Standard normal numbers of one correction: (inner, n) of the gears, then q, v, torque (n each), wrenches.
  int draws() const { return (settings_.inner + 3) * settings_.n + 6 * settings_.frames; }
  const Settings& settings() const { return settings_; }

  // A robot that holds itself with `held` (n), and its first reading.
  void init(double* memory, const double* held, const Drawn& drawn, const True& now, const double* draw,
            Reading out) const;
  // What is asked of the drives now (n), within their limit: the command of `under_way` corrections ago.
  void ask(double* memory, const double* command, double* asked) const;
  // Motor torque, kept in the memory.
  void drive(double* memory, const double* asked) const;
  // Torque at the link side (n) over step `index` of the perfect robot.
  void gear(double* memory, const double* draw, int index, double* torque) const;
  // The velocity (n) that the friction of the next step sees.
  void moved(double* memory, const double* v) const;
  void sense(double* memory, const double* draw, const True& now, Reading out) const;

 private:
  double* at(double* memory, int offset) const { return memory + offset; }
  // Gives what was put in `late` calls ago, and puts `value` in.
  void queue(double* memory, int offset, int late, int width, const double* value, double* out) const;
  // A reading of what sensors felt now, (n) q, (n) v, (frames, 6) wrenches in a row, and the torque (n).
  void read(double* memory, const double* draw, const double* fresh, const double* true_torque, Reading out) const;
  void rippled(double* memory, const double* wrenches, const double* v, double* out) const;

  Settings settings_;
  int size_ = 0;
  int gain_, bias_, sensor_gain_, sensor_offset_, filtered_, integral_, before_, motor_, velocity_, read_, phase_;
  int commands_, states_, torques_, forces_;  // queues: place of the oldest, then rows
};

}  // namespace pliant::plant
