// What is true of a simulated robot and of the things around it, for the log.
#pragma once
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <utility>
#include <vector>

namespace pliant::plant {

class TruthRow {
 public:
  // Args: limits of the joints (n) [rad, m]; sites and bodies whose places are told.
  TruthRow(std::vector<double> lower, std::vector<double> upper, std::vector<int> sites, std::vector<int> bodies)
      : lower_(std::move(lower)), upper_(std::move(upper)), sites_(std::move(sites)), bodies_(std::move(bodies)) {
    if (lower_.size() != upper_.size()) throw std::invalid_argument("a joint has two limits");
  }

  // Numbers in the row: q, v, torque and how far beyond its limits each joint is, (n) each; positions (sites, 3);
  // rotations (sites, 9); position and quaternion of the bodies (bodies, 7).
  size_t size() const { return 4 * lower_.size() + 12 * sites_.size() + 7 * bodies_.size(); }
  // Whether joints, sites and bodies are those of a model.
  bool fits(const mjModel& model) const {
    return lower_.size() <= size_t(model.nv) && within(sites_, model.nsite) && within(bodies_, model.nbody);
  }

  void read(const mjData& data, double* out) const {
    const size_t n = lower_.size();
    double* beyond = std::copy(data.qfrc_applied, data.qfrc_applied + n,
                               std::copy(data.qvel, data.qvel + n, std::copy(data.qpos, data.qpos + n, out)));
    for (size_t j = 0; j < n; ++j) {
      const double excess = std::max(lower_[j] - out[j], out[j] - upper_[j]);
      beyond[j] = excess <= 0 ? 0 : excess;  // what is not a number stays so
    }
    out = beyond + n;
    for (const int site : sites_) out = std::copy(data.site_xpos + 3 * site, data.site_xpos + 3 * site + 3, out);
    for (const int site : sites_) out = std::copy(data.site_xmat + 9 * site, data.site_xmat + 9 * site + 9, out);
    for (const int body : bodies_)
      out = std::copy(data.xquat + 4 * body, data.xquat + 4 * body + 4,
                      std::copy(data.xpos + 3 * body, data.xpos + 3 * body + 3, out));
  }

 private:
  static bool within(const std::vector<int>& ids, int count) {
    return std::all_of(ids.begin(), ids.end(), [count](int id) { return id >= 0 && id < count; });
  }

  std::vector<double> lower_, upper_;
  std::vector<int> sites_, bodies_;
};

}  // namespace pliant::plant
