#include "physics.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace pliant::plant {

namespace {

void add_cross(const double* a, const double* b, double* out) {
  out[0] += a[1] * b[2] - a[2] * b[1];
  out[1] += a[2] * b[0] - a[0] * b[2];
  out[2] += a[0] * b[1] - a[1] * b[0];
}

// R' x of a row-major R.
void turned_back(const double* R, const double* x, double* out) {
  for (int i = 0; i < 3; ++i) out[i] = R[i] * x[0] + R[3 + i] * x[1] + R[6 + i] * x[2];
}

void times(const double* A, const double* x, double* out) {
  for (int i = 0; i < 3; ++i) out[i] = A[3 * i] * x[0] + A[3 * i + 1] * x[1] + A[3 * i + 2] * x[2];
}

}  // namespace

Physics::Physics(World world, const Library& library, const mjModel* model)
    : world_(std::move(world)), library_(library), model_(model) {
  if (world_.frame_site.size() > 63) throw std::invalid_argument("at most 63 frames of a robot can touch things");
}

int Physics::outcome_size() const {
  return 3 * world_.n + 6 * static_cast<int>(world_.frame_site.size() + world_.sensors.size());
}

Outcome Physics::outcome(double* row) const {
  double* contacts = row + 3 * world_.n;
  return {row, row + world_.n, row + 2 * world_.n, contacts, contacts + 6 * world_.frame_site.size()};
}

bool Physics::step(mjData* data, const double* torque, const std::vector<Push>& pushes, Outcome out,
                   std::uint64_t& touching) const {
  limit(torque, out.torque);
  for (int left = world_.substeps; left > 0; --left) {
    apply(data, out.torque, pushes);
    library_.step2(model_, data);
    if (left == 1) read_contacts(data, out.contacts, touching);
    library_.step1(model_, data);
  }
  return read_robot(data, out);
}

void Physics::hold(mjData* data, const double* torque, const std::vector<Push>& pushes, Outcome out) const {
  limit(torque, out.torque);
  apply(data, out.torque, pushes);
}

bool Physics::read(mjData* data, Contacts contacts, Outcome out, std::uint64_t& touching) const {
  std::fill(out.contacts, out.contacts + 6 * world_.frame_site.size(), 0.0);
  touching = 0;
  for (size_t slot = 0; slot < world_.frame_of_slot.size(); ++slot) {
    const double *force = contacts.force + 3 * slot, *point = contacts.point + 3 * slot;
    const int frame = world_.frame_of_slot[slot];
    if (frame < 0 || (force[0] == 0 && force[1] == 0 && force[2] == 0)) continue;
    const double* origin = data->site_xpos + 3 * world_.frame_site[size_t(frame)];
    double *wrench = out.contacts + 6 * frame, lever[3];
    for (int i = 0; i < 3; ++i) {
      lever[i] = point[i] - origin[i];
      wrench[i] += force[i];
    }
    add_cross(lever, force, wrench + 3);
    touching |= std::uint64_t{1} << frame;
  }
  return read_robot(data, out);
}

void Physics::limit(const double* torque, double* limited) const {
  for (int i = 0; i < world_.n; ++i) {
    const double limit = world_.limit[size_t(i)];
    limited[i] = torque[i] < -limit ? -limit : torque[i] > limit ? limit : torque[i];
  }
}

// Joints and sensors. False: a joint's speed is not finite or not allowed.
bool Physics::read_robot(mjData* data, Outcome out) const {
  bool allowed = true;
  for (int i = 0; i < world_.n; ++i) {
    out.q[i] = data->qpos[i];
    out.v[i] = data->qvel[i];
    allowed = allowed && std::abs(out.v[i]) <= world_.fastest[size_t(i)];
  }
  if (!allowed) return false;
  for (size_t k = 0; k < world_.sensors.size(); ++k)
    read_sensor(data, world_.sensors[k], out.contacts, out.readings + 6 * k);
  return true;
}

void Physics::apply(mjData* data, const double* torque, const std::vector<Push>& pushes) const {
  std::fill(data->qfrc_applied, data->qfrc_applied + model_->nv, 0.0);
  for (int i = 0; i < world_.n; ++i)
    data->qfrc_applied[i] = world_.coriolis ? torque[i] + data->qfrc_bias[i] : torque[i];
  const double none[3] = {0, 0, 0};
  for (const Push& push : pushes) {
    if (!(push.start <= data->time && data->time < push.stop)) continue;
    library_.apply_force(model_, data, push.force, none, data->site_xpos + 3 * push.site,
                         model_->site_bodyid[push.site], data->qfrc_applied);
  }
}

void Physics::read_contacts(mjData* data, double* contacts, std::uint64_t& touching) const {
  std::fill(contacts, contacts + 6 * world_.frame_site.size(), 0.0);
  touching = 0;
  for (int k = 0; k < data->ncon; ++k) {
    const mjContact& contact = data->contact[k];
    for (int side = 0; side < 2; ++side) {
      const int geom = contact.geom[side];
      const int frame = geom < 0 ? -1 : world_.frame_of_geom[size_t(geom)];
      if (frame < 0) continue;
      double local[6], force[3], lever[3];
      library_.contact_force(model_, data, k, local);
      turned_back(contact.frame, local, force);
      const double* origin = data->site_xpos + 3 * world_.frame_site[size_t(frame)];
      double* wrench = contacts + 6 * frame;
      for (int i = 0; i < 3; ++i) {
        force[i] = side == 0 ? -force[i] : force[i];
        lever[i] = contact.pos[i] - origin[i];
        wrench[i] += force[i];
      }
      add_cross(lever, force, wrench + 3);
      touching |= std::uint64_t{1} << frame;
    }
  }
}

void Physics::read_sensor(mjData* data, const Sensor& sensor, const double* contacts, double* reading) const {
  const double *R = data->site_xmat + 9 * sensor.site, *origin = data->site_xpos + 3 * sensor.site;
  double force[3] = {0, 0, 0}, moment[3] = {0, 0, 0};
  for (const int frame : sensor.felt) {
    const double *wrench = contacts + 6 * frame, *at = data->site_xpos + 3 * world_.frame_site[size_t(frame)];
    double lever[3];
    for (int i = 0; i < 3; ++i) {
      lever[i] = at[i] - origin[i];
      force[i] += wrench[i];
      moment[i] += wrench[3 + i];
    }
    add_cross(lever, wrench, moment);
  }
  turned_back(R, force, reading);
  turned_back(R, moment, reading + 3);
  if (sensor.mass > 0) add_carried(data, sensor, reading);
}

// Weight and inertial force of the mass behind a sensor, at its frame and in its axes.
void Physics::add_carried(mjData* data, const Sensor& sensor, double* reading) const {
  library_.accelerations(model_, data);
  double motion[6], spin[6];  // angular first; linear acceleration minus gravity
  library_.acceleration(model_, data, mjOBJ_SITE, sensor.site, motion, 1);
  library_.velocity(model_, data, mjOBJ_SITE, sensor.site, spin, 1);
  const double *turning = motion, *omega = spin, *center = sensor.center;
  double inner[3] = {0, 0, 0}, acceleration[3] = {motion[3], motion[4], motion[5]};
  add_cross(turning, center, acceleration);
  add_cross(omega, center, inner);
  add_cross(omega, inner, acceleration);
  double force[3], moment[3] = {0, 0, 0}, euler[3], spun[3], gyro[3] = {0, 0, 0};
  for (int i = 0; i < 3; ++i) force[i] = -sensor.mass * acceleration[i];
  add_cross(center, force, moment);
  times(sensor.inertia, turning, euler);
  times(sensor.inertia, omega, spun);
  add_cross(omega, spun, gyro);
  for (int i = 0; i < 3; ++i) {
    reading[i] += force[i];
    reading[3 + i] += moment[i] - euler[i] - gyro[i];
  }
}

}  // namespace pliant::plant
