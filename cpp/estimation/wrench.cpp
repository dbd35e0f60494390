#include "wrench.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace pliant::estimation {
namespace {

constexpr double turn = 2 * 3.14159265358979323846;  // [rad]
constexpr double clock_rounding = 1e-9;              // [s]

}  // namespace

WrenchStage::WrenchStage(std::shared_ptr<const Tree> robot, WrenchSettings settings)
    : robot_(std::move(robot)), settings_(std::move(settings)) {}

std::unique_ptr<Stage> WrenchStage::bound(int n, Names& frames) const {
  auto made = std::make_unique<WrenchStage>(robot_, settings_);
  made->n_ = n;
  Names touching;
  if (robot_) {
    for (const std::string& name : frames) {
      const auto beyond = settings_.contact_frames.find(name);
      const auto load = settings_.carried.find(name);
      const bool elsewhere = beyond != settings_.contact_frames.end() && beyond->second != name;
      const bool loaded = load != settings_.carried.end();
      touching.push_back(elsewhere ? beyond->second : name);
      made->sensors_.push_back(
          {robot_->frame(name), robot_->frame(touching.back()), elsewhere, loaded, loaded ? load->second : Load()});
    }
    made->bodies_.resize(size_t(n));
    made->acceleration_.resize(size_t(n));
  }
  frames = touching;
  return made;
}

int WrenchStage::size() const {
  return n_ + count() + (accelerates() ? 1 + 2 * n_ : 0) + (settings_.tare.wanted ? TareMemory::size(count()) : 0);
}

void WrenchStage::init(const Reading& reading, double* memory) const {
  std::fill(memory, memory + size(), 0.0);
  std::copy(reading.v, reading.v + n_, memory);
  std::fill(above(memory), above(memory) + count(), -std::numeric_limits<double>::infinity());
  if (accelerates()) {
    double* moving = motion(memory);
    moving[0] = reading.time;
    for (int k : {0, 1}) std::copy(reading.v, reading.v + n_, moving + 1 + k * n_);
  }
  if (settings_.tare.wanted) tare(memory).start() = reading.time;
}

// The bodies of now; velocities and accelerations only where a sensor carries something. Differences of v after two
// equal first-order stages (JointAcceleration).
void WrenchStage::move(const Reading& reading, double* memory) {
  if (!accelerates()) {
    robot_->move(reading.q, nullptr, nullptr, bodies_.data());
    return;
  }
  double* moving = motion(memory);
  double *first = moving + 1, *second = first + n_;
  const double period = reading.time - moving[0];
  const double gain = -std::expm1(-turn * settings_.acceleration_cutoff * period);
  for (int j = 0; j < n_; ++j) {
    acceleration_[size_t(j)] = 0;
    if (period <= 0) continue;
    first[j] += gain * (reading.v[j] - first[j]);
    const double before = second[j];
    second[j] += gain * (first[j] - before);
    acceleration_[size_t(j)] = (second[j] - before) / period;
  }
  if (period > 0) moving[0] = reading.time;
  robot_->move(reading.q, reading.v, acceleration_.data(), bodies_.data());
}

// What no load explains of a reading, both in the sensor's axes.
void WrenchStage::unexplained(int sensor, const Body& at, const TareMemory* tare, const double* reading, Vec3& force,
                              Vec3& moment) const {
  const Sensor& s = sensors_[size_t(sensor)];
  force = load(reading);
  moment = load(reading + 3);
  const bool tared = tare && tare->found();
  if (!s.loaded && !tared) return;
  const Rotation R = at.pose.rotation();
  const SensorMotion motion = {R.to_local(at.acceleration) - R.to_local(robot_->gravity()), R.to_local(at.spin),
                               R.to_local(at.spinning)};
  Vec3 pull, twist;
  reading_of(tared ? s.load.plus(load_of(tare->load(sensor))) : s.load, motion, pull, twist);
  force = force - pull;
  moment = moment - twist;
}

// One more reading for the tare; it is found with the first one that is `duration` old or older.
Refusal WrenchStage::take_in(const Reading& reading, const TareMemory& tare) const {
  const TareSettings& how = settings_.tare;
  double speed = 0;
  for (int j = 0; j < n_; ++j) speed = std::max(speed, std::abs(reading.v[j]));
  if (speed > how.still) return {Fault::moves_while_tared, {speed, how.still}};
  tare.count() += 1;
  const bool last = reading.time - tare.start() >= how.duration - clock_rounding;
  for (int i = 0; i < count(); ++i) {
    const Body at = robot_->at(sensors_[size_t(i)].frame, bodies_.data());
    double* sums = tare.sums(i);
    Vec3 force, moment;
    unexplained(i, at, &tare, reading.wrenches + 6 * i, force, moment);
    store(load(sums) + force, sums);
    store(load(sums + 3) + moment, sums + 3);
    store(load(sums + 6) + at.pose.rotation().to_local(robot_->gravity()), sums + 6);
    const double share = 1 / tare.count();
    if (last) store(tared(how, share * load(sums), share * load(sums + 3), share * load(sums + 6)), tare.load(i));
  }
  if (last) tare.finish();
  return {};
}

Refusal WrenchStage::step(const Reading& reading, Belief& belief, double* memory) {
  for (int j = 0; j < n_; ++j) {
    memory[j] += settings_.velocity_gain * (reading.v[j] - memory[j]);
    belief.q[j] = reading.q[j];
    belief.v[j] = memory[j];
    belief.torque[j] = reading.torque[j];
  }
  if (!robot_) return {};
  move(reading, memory);
  const TareMemory tares = tare(memory);
  const bool taring = settings_.tare.wanted && !tares.found();
  if (taring)
    if (const Refusal refusal = take_in(reading, tares); refusal.fault != Fault::none) return refusal;
  for (int i = 0; i < count(); ++i) {
    const Sensor& s = sensors_[size_t(i)];
    const Body at = robot_->at(s.frame, bodies_.data());
    Vec3 force, moment;
    if (!taring) unexplained(i, at, settings_.tare.wanted ? &tares : nullptr, reading.wrenches + 6 * i, force, moment);
    force = at.pose.rotation().to_world(force);
    moment = at.pose.rotation().to_world(moment);
    if (s.beyond) moment = moment + cross(at.pose.p - robot_->at(s.touching, bodies_.data()).pose.p, force);
    store(force, belief.wrenches + 6 * i);
    store(moment, belief.wrenches + 6 * i + 3);
    double& last = above(memory)[i];
    const bool touched = reading.time - last <= settings_.linger;
    if (norm(force) > (touched ? settings_.end : settings_.begin)) last = reading.time;
    belief.touches[i] = reading.time - last <= settings_.linger;
  }
  return {};
}

}  // namespace pliant::estimation
