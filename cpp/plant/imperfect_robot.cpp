#include "imperfect_robot.hpp"

#include <algorithm>
#include <cmath>

namespace pliant::plant {

namespace {

constexpr double turn = 6.283185307179586;  // [rad]

double within(double value, double limit) { return value < -limit ? -limit : value > limit ? limit : value; }

void copy(const double* from, int count, double* to) { std::copy(from, from + count, to); }

}  // namespace

ImperfectRobot::ImperfectRobot(Settings settings) : settings_(std::move(settings)) {
  const int n = settings_.n, six = 6 * settings_.frames;
  const Sensors& s = settings_.sensors;
  for (int* row : {&gain_, &bias_, &sensor_gain_, &sensor_offset_, &filtered_, &integral_, &before_, &motor_,
                   &velocity_, &read_}) {
    *row = size_;
    size_ += n;
  }
  const auto take = [this](int& offset, int count) {
    offset = size_;
    size_ += count;
  };
  take(phase_, 1);
  take(commands_, 1 + settings_.under_way * n);
  take(states_, 1 + s.late * (2 * n + six));
  take(torques_, 1 + s.late_torque * n);
  take(forces_, 1 + s.late_force * six);
}

void ImperfectRobot::init(double* memory, const double* held, const Drawn& drawn, const True& now, const double* draw,
                          Reading out) const {
  const int n = settings_.n, six = 6 * settings_.frames;
  const Sensors& s = settings_.sensors;
  std::fill(memory, memory + size_, 0.0);
  copy(drawn.gain, n, at(memory, gain_));
  copy(drawn.bias, n, at(memory, bias_));
  copy(drawn.sensor_gain, n, at(memory, sensor_gain_));
  copy(drawn.sensor_offset, n, at(memory, sensor_offset_));
  copy(held, n, at(memory, motor_));
  copy(now.v, n, at(memory, velocity_));
  for (int i = 0; i < n; ++i) memory[filtered_ + i] = within(held[i], settings_.gears.limit[i]);
  for (int k = 0; k < settings_.under_way; ++k) copy(held, n, at(memory, commands_ + 1 + k * n));
  for (int k = 0; k < s.late; ++k) {
    double* row = at(memory, states_ + 1 + k * (2 * n + six));
    copy(now.q, n, row);
    copy(now.v, n, row + n);
    copy(now.wrenches, six, row + 2 * n);
  }
  for (int k = 0; k < s.late_torque; ++k) copy(now.torque, n, at(memory, torques_ + 1 + k * n));
  for (int k = 0; k < s.late_force; ++k) copy(now.wrenches, six, at(memory, forces_ + 1 + k * six));
  std::vector<double> fresh(size_t(2 * n + six));
  copy(now.q, n, fresh.data());
  copy(now.v, n, fresh.data() + n);
  copy(now.wrenches, six, fresh.data() + 2 * n);
  read(memory, draw, fresh.data(), now.torque, out);
  copy(out.torque, n, at(memory, before_));
}

void ImperfectRobot::queue(double* memory, int offset, int late, int width, const double* value, double* out) const {
  if (late == 0) {
    copy(value, width, out);
    return;
  }
  const int oldest = static_cast<int>(memory[offset]);
  double* row = memory + offset + 1 + oldest * width;
  for (int i = 0; i < width; ++i) {
    const double old = row[i];
    row[i] = value[i];
    out[i] = old;
  }
  memory[offset] = oldest + 1 == late ? 0 : oldest + 1;
}

void ImperfectRobot::ask(double* memory, const double* command, double* asked) const {
  queue(memory, commands_, settings_.under_way, settings_.n, command, asked);
  for (int i = 0; i < settings_.n; ++i) asked[i] = within(asked[i], settings_.gears.limit[i]);
}

void ImperfectRobot::drive(double* memory, const double* asked) const {
  const TorqueLoop& g = settings_.loop;
  const double* measured = at(memory, read_);
  double *integral = at(memory, integral_), *before = at(memory, before_), *motor = at(memory, motor_);
  for (int i = 0; i < settings_.n; ++i) {
    const double error = measured[i] - asked[i];
    const double next = integral[i] + g.period * error;
    const double rate = (measured[i] - before[i]) / g.period;
    const double wanted = asked[i] - g.gain_p * error - g.gain_i * next - g.gain_d * rate;
    motor[i] = within(wanted, settings_.gears.limit[i]);
    if (!((wanted - motor[i]) * error < 0)) integral[i] = next;  // else it would push further beyond the limit
    before[i] = measured[i];
  }
}

void ImperfectRobot::gear(double* memory, const double* draw, int index, double* torque) const {
  const Gears& g = settings_.gears;
  const int n = settings_.n;
  const double *gain = at(memory, gain_), *bias = at(memory, bias_), *v = at(memory, velocity_);
  const double* motor = at(memory, motor_);
  double* filtered = at(memory, filtered_);
  for (int i = 0; i < n; ++i) {
    const double limited = within(motor[i], g.limit[i]);
    filtered[i] = limited + g.kept * (filtered[i] - limited);
    const double dry = g.dry[i] == 0 ? 0 : g.dry[i] * std::tanh(v[i] / g.friction_velocity);
    const double friction = dry + g.viscous[i] * v[i];
    torque[i] = gain[i] * filtered[i] + bias[i] - friction + g.noise[i] * draw[index * n + i];
  }
}

void ImperfectRobot::moved(double* memory, const double* v) const { copy(v, settings_.n, at(memory, velocity_)); }

void ImperfectRobot::rippled(double* memory, const double* wrenches, const double* v, double* out) const {
  const Ripple& r = settings_.ripple;
  double squares = 0;
  for (int i = 0; i < settings_.n; ++i) squares += v[i] * v[i];
  const double speed = std::sqrt(squares) / r.speed;
  double& phase = memory[phase_];
  phase = std::fmod(phase + turn * r.frequency * speed * settings_.loop.period, turn);
  const double share = r.amplitude == 0 ? 0 : r.amplitude / r.force * speed * std::sin(phase);
  for (int i = 0; i < 6 * settings_.frames; ++i) out[i] = wrenches[i] * (1.0 + share);
}

void ImperfectRobot::sense(double* memory, const double* draw, const True& now, Reading out) const {
  const int n = settings_.n;
  static thread_local std::vector<double> fresh;
  fresh.resize(size_t(2 * n + 6 * settings_.frames));
  copy(now.q, n, fresh.data());
  copy(now.v, n, fresh.data() + n);
  rippled(memory, now.wrenches, now.v, fresh.data() + 2 * n);
  read(memory, draw, fresh.data(), now.torque, out);
}

void ImperfectRobot::read(double* memory, const double* draw, const double* fresh, const double* true_torque,
                          Reading out) const {
  const Sensors& s = settings_.sensors;
  const int n = settings_.n, six = 6 * settings_.frames;
  static thread_local std::vector<double> old;
  old.resize(size_t(2 * n + six));
  queue(memory, states_, s.late, 2 * n + six, fresh, old.data());
  queue(memory, torques_, s.late_torque, n, true_torque, out.torque);
  queue(memory, forces_, s.late_force, six, old.data() + 2 * n, out.wrenches);
  const double *gain = at(memory, sensor_gain_), *offset = at(memory, sensor_offset_);
  const double *q = draw + settings_.inner * n, *v = q + n, *torque = v + n, *wrench = torque + n;
  for (int i = 0; i < n; ++i) {
    out.q[i] = old[size_t(i)] + s.q[size_t(i)] * q[i];
    out.v[i] = old[size_t(n + i)] + s.v[size_t(i)] * v[i];
    out.torque[i] = gain[i] * out.torque[i] + offset[i] + s.torque[size_t(i)] * torque[i];
  }
  for (int i = 0; i < six; ++i) out.wrenches[i] += s.wrench[i % 6 / 3] * wrench[i];
  copy(out.torque, n, at(memory, read_));
}

}  // namespace pliant::plant
