// NumPy arrays in and out.
#pragma once
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <cmath>
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

#include "../../shared/python_signals.hpp"

namespace pliant::mpc::binding {

namespace nb = nanobind;
using namespace nb::literals;

using Input = nb::ndarray<const double, nb::c_contig, nb::device::cpu>;

// Copies an array-like of the given shape into `out`.
inline void read(nb::handle value, const char* name, const std::vector<size_t>& shape, double* out) {
  Input a;
  if (!nb::try_cast(value, a, false)) {
    const nb::object numpy = nb::module_::import_("numpy");
    a = nb::cast<Input>(numpy.attr("ascontiguousarray")(value, "dtype"_a = "float64"));
    if (shape.empty() && a.ndim() == 1) throw std::invalid_argument(std::string(name) + " must be a number");
  }
  std::vector<size_t> got;
  for (size_t i = 0; i < a.ndim(); ++i) got.push_back(a.shape(i));
  if (got != shape)
    throw std::invalid_argument(std::string(name) + " must have shape " + shape_text(shape) + ", got " +
                                shape_text(got));
  std::memcpy(out, a.data(), a.size() * sizeof(double));
}

inline void require_finite(const char* name, const std::vector<double>& values) {
  for (double v : values)
    if (!std::isfinite(v)) throw std::invalid_argument(std::string(name) + " must be finite");
}

using Output = nb::ndarray<nb::numpy, double>;

// A NumPy array that owns what it was filled with.
inline nb::object array(std::vector<double> values, std::vector<size_t> shape) {
  auto* kept = new std::vector<double>(std::move(values));
  const nb::capsule owner(kept, [](void* p) noexcept { delete static_cast<std::vector<double>*>(p); });
  return nb::cast(Output(kept->data(), shape.size(), shape.data(), owner), nb::rv_policy::reference);
}

}  // namespace pliant::mpc::binding
