// Extension module pliant._references.
#include <nanobind/stl/vector.h>

#include "../shared/numpy_arrays.hpp"
#include "spline.hpp"

namespace {

using namespace nanobind::literals;
namespace nb = nanobind;
using pliant::Packed;
using pliant::references::Spline;

void build(Spline* self, std::vector<double> times, double step, Packed<const double, 3> pieces,
           std::vector<double> first, std::vector<double> last) {
  Spline made(std::move(times), step, pieces.data(), std::move(first), std::move(last));
  if (pieces.shape(0) != made.pieces() || pieces.shape(1) != 4 || pieces.shape(2) != made.width())
    throw std::invalid_argument("the coefficients must have shape (samples - 1, 4, width)");
  new (self) Spline(std::move(made));
}

void at(const Spline& spline, double time, const Packed<double, 1>& out) {
  if (out.size() != spline.width()) throw std::invalid_argument("a row must have the width of the spline");
  if (time != time) throw std::invalid_argument("a time must be a number");
  spline.at(time, out.data());
}

}  // namespace

NB_MODULE(_references, m) {
  m.doc() = "Functions of time that a loop asks for in each tick.";
  nb::class_<Spline>(m, "Spline")
      .def("__init__", &build, nb::keep_alive<1, 4>(), "times"_a, "step"_a, "pieces"_a.noconvert(), "first"_a, "last"_a)
      .def("at", &at, "time"_a, "out"_a.noconvert());
}
