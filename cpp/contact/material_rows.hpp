// A contact's material from rows of numbers.
#pragma once

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <vector>

#include "arrays.hpp"
#include "graded.hpp"

namespace pliant::contact {

inline Material material_of(const double* m) { return {m[0], m[1], m[2], m[3], m[4], m[5], m[6], m[7]}; }

// Args: line: (2, 3) a point of it and its unit direction, with places (k,) and material (k, 8); none: one material.
inline Graded graded(const Constants& material, const std::optional<Constants>& line,
                     const std::optional<Constants>& places) {
  if (line.has_value() != places.has_value()) throw std::invalid_argument("line and places go together");
  if (!line) {
    require_size(material.size(), kMaterialSize, "material");
    return material_of(material.data());
  }
  require_size(line->size(), 6, "line");
  const std::vector<double> at(places->data(), places->data() + places->size());
  if (at.empty() || std::adjacent_find(at.begin(), at.end(), [](double a, double b) { return !(a < b); }) != at.end())
    throw std::invalid_argument("places must rise");
  require_size(material.size(), kMaterialSize * at.size(), "material");
  std::vector<Material> made;
  for (size_t i = 0; i < at.size(); ++i) made.push_back(material_of(material.data() + kMaterialSize * i));
  return {load(line->data()), load(line->data() + 3), at, made};
}

}  // namespace pliant::contact
