// A material that changes along a straight line.
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "law.hpp"

namespace pliant::contact {

// Between two places on the line every number of the material is linear; beyond the first and last one it stays. Across
// the line it is the same.
class Graded {
 public:
  Graded(const Material& same) : materials_{same} {}  // NOLINT(google-explicit-constructor): one that does not change
  // Args: origin, direction: of the line, world [m], unit. places: [m] along it, rising, one for each material.
  Graded(const Vec3& origin, const Vec3& direction, std::vector<double> places, std::vector<Material> materials)
      : origin_(origin), direction_(direction), places_(std::move(places)), materials_(std::move(materials)) {}

  Material at(const Vec3& point) const {
    if (places_.empty()) return materials_.front();
    const double s = dot(direction_, point - origin_);
    const size_t next = static_cast<size_t>(std::upper_bound(places_.begin(), places_.end(), s) - places_.begin());
    if (next == 0) return materials_.front();
    if (next == places_.size()) return materials_.back();
    const double share = (s - places_[next - 1]) / (places_[next] - places_[next - 1]);
    return between(materials_[next - 1], materials_[next], share);
  }

 private:
  Vec3 origin_{}, direction_{};
  std::vector<double> places_;
  std::vector<Material> materials_;
};

}  // namespace pliant::contact
