// Arrays between Python and the contact law.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "../shared/numpy_arrays.hpp"

namespace pliant::contact {

namespace nb = nanobind;

using Doubles = Packed<double>;
using Constants = Packed<const double>;
using Integers = nb::ndarray<const int32_t, nb::c_contig, nb::device::cpu>;

inline void require_size(size_t got, size_t wanted, const char* name) {
  if (got != wanted)
    throw std::invalid_argument(std::string(name) + " must have " + std::to_string(wanted) + " entries, got " +
                                std::to_string(got));
}

inline uintptr_t address(const nb::object& owner) { return nb::cast<uintptr_t>(owner.attr("_address")); }

template <class Array>
auto array(const nb::object& owner, const char* name) {
  return nb::cast<Array>(owner.attr(name)).data();
}

// A new array that Python owns.
inline nb::ndarray<nb::numpy, double> owned(std::vector<double> values, std::initializer_list<size_t> shape) {
  auto* kept = new std::vector<double>(std::move(values));
  nb::capsule owner(kept, [](void* p) noexcept { delete static_cast<std::vector<double>*>(p); });
  return nb::ndarray<nb::numpy, double>(kept->data(), shape, owner);
}

inline size_t rows_of_three(const Constants& points, const char* name) {
  if (points.ndim() != 2 || points.shape(1) != 3)
    throw std::invalid_argument(std::string(name) + " must have shape (k, 3)");
  return points.shape(0);
}

}  // namespace pliant::contact
