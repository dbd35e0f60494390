#include "horizon.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace pliant::mpc::step {
namespace {

constexpr double same_instant = 1e-9;  // [s]
constexpr double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};

void copy(double* to, const double* from, int count) { std::memcpy(to, from, size_t(count) * sizeof(double)); }

bool all_finite(const double* values, int count) {
  double sum = 0;
  for (int i = 0; i < count; ++i) sum += values[i] - values[i];  // zero, or not a number
  return sum == 0;
}

void between(const Rows& rows, int at, int after, double share, int count, double* out) {
  const double *a = rows.row(at), *b = rows.row(after);
  for (int i = 0; i < count; ++i) out[i] = a[i] + share * (b[i] - a[i]);
}

bool at_the_nodes(const Settings& s, const Wanted& w) {
  const Ahead& ahead = *w.ahead;
  if (ahead.count != s.N() + 1) return false;
  for (int k = 0; k < ahead.count; ++k) {
    const double wanted = w.time + s.compensation.lead + s.options.dt * k;
    if (!(std::abs(*ahead.time.row(k) - wanted) < same_instant)) return false;
  }
  return true;
}

void sample(const Settings& s, const Wanted& w, Horizon& horizon) {
  const Ahead& ahead = *w.ahead;
  const bool exact = at_the_nodes(s, w);
  const int last = ahead.count - 1;
  for (int k = 0; k <= s.N(); ++k) {
    NodeReference& node = horizon.nodes[size_t(k)];
    int at = k, after = k;
    double share = 0;
    if (!exact) {
      const double time = w.time + s.compensation.lead + s.options.dt * k;
      at = 0;
      while (at < last && *ahead.time.row(at + 1) <= time + same_instant) ++at;
      after = std::min(at + 1, last);
      const double span = std::max(*ahead.time.row(after) - *ahead.time.row(at), 1e-12);
      share = std::min(std::max((time - *ahead.time.row(at)) / span, 0.0), 1.0);
    }
    between(ahead.position, at, after, share, 3, node.position);
    between(ahead.velocity, at, after, share, 6, node.velocity);
    between(ahead.wrench, at, after, share, 6, node.wrench);
    if (horizon.postured) between(ahead.posture, at, after, share, s.n(), node.posture);
    if (horizon.oriented) copy(node.rotation, ahead.rotation.row(at), 9);
    if (horizon.turning) copy(node.task_rotation, ahead.task_rotation.row(at), 9);
    node.phase = ahead.phase.empty() ? unnamed_phase : ahead.phase[size_t(at)];
  }
}

void extrapolate(const Settings& s, const Wanted& w, Horizon& horizon) {
  for (int k = 0; k <= s.N(); ++k) {
    NodeReference& node = horizon.nodes[size_t(k)];
    const double elapsed = s.compensation.lead + s.options.dt * k;
    for (int i = 0; i < 3; ++i) node.position[i] = w.task.position[i] + elapsed * w.task.velocity[i];
    copy(node.velocity, w.task.velocity, 6);
    copy(node.wrench, w.task.wrench, 6);
    if (horizon.oriented) copy(node.rotation, w.task.rotation, 9);
    if (horizon.turning) copy(node.task_rotation, w.task.task_rotation, 9);
    if (horizon.postured) copy(node.posture, w.posture, s.n());
    node.phase = w.phase;
  }
}

}  // namespace

Fault along_horizon(const Settings& s, const Wanted& w, Horizon& horizon) {
  if (w.has_ahead) {
    horizon.oriented = w.ahead->rotation.data;
    horizon.turning = w.ahead->task_rotation.data;
    horizon.postured = w.ahead->posture.data;
    sample(s, w, horizon);
  } else {
    if (!w.has_task) return Fault::no_task;
    horizon.oriented = w.task.rotation;
    horizon.turning = w.task.task_rotation;
    horizon.postured = w.posture;
    extrapolate(s, w, horizon);
  }
  for (const NodeReference& node : horizon.nodes) {
    const bool finite = all_finite(node.position, 3) && all_finite(node.velocity, 6) && all_finite(node.wrench, 6) &&
                        (!horizon.oriented || all_finite(node.rotation, 9));
    if (!finite) return Fault::reference_not_finite;
  }
  return Fault::none;
}

const double* contact_axes(const Settings& s, const double* rotation, const double* task_rotation) {
  if (s.model.axes == Axes::surface) return task_rotation ? task_rotation : s.surface;
  return s.model.axes == Axes::world || !rotation ? identity : rotation;
}

void in_contact_axes(const Settings& s, const double* wrench, const double* axes, double* out) {
  double turned[6];
  for (int part = 0; part < 6; part += 3)
    for (int j = 0; j < 3; ++j)
      turned[part + j] = axes[j] * wrench[part] + axes[3 + j] * wrench[part + 1] + axes[6 + j] * wrench[part + 2];
  const double* known = s.model.axes == Axes::world ? wrench : turned;
  if (s.m() == 1)
    out[0] = known[2];
  else
    copy(out, known, s.m());
}

void normal_of(const Settings& s, const double* task_rotation, double* normal) {
  const double* axes = s.model.axes == Axes::surface ? contact_axes(s, nullptr, task_rotation) : identity;
  for (int i = 0; i < 3; ++i) normal[i] = axes[3 * i + 2];
}

}  // namespace pliant::mpc::step
