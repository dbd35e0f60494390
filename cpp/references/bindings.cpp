// Extension module pliant._references.
#include <nanobind/stl/vector.h>

#include "../shared/contract.hpp"
#include "../shared/numpy_arrays.hpp"
#include "bind_exploration.hpp"
#include "spline.hpp"
#include "superposed.hpp"
#include "task_rows.hpp"

namespace {

using namespace nanobind::literals;
namespace nb = nanobind;
using pliant::Packed;
using pliant::references::RowsAhead;
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

void rows(const Spline& spline, const Packed<const double, 1>& times, const Packed<double, 2>& out) {
  if (out.shape(0) != times.size() || out.shape(1) != spline.width())
    throw std::invalid_argument("there must be a row of the spline's width for every time");
  for (size_t i = 0; i < times.size(); ++i) {
    if (times.data()[i] != times.data()[i]) throw std::invalid_argument("a time must be a number");
    spline.at(times.data()[i], out.data() + i * spline.width());
  }
}

nb::object row(RowsAhead& rows, double time, double period) {
  const double* now = rows.now(time, period);
  nb::object made = pliant::new_array({npy_intp(rows.width())});
  std::copy_n(now, rows.width(), pliant::data_of(made));
  return made;
}

nb::object task(RowsAhead& rows, double time, double period, nb::handle offset, const std::vector<double>& height) {
  const double* now = rows.now(time, period);
  return pliant::references::parts_of(now, rows.width(), offset, height);
}

nb::object parts(const Packed<const double, 1>& row, nb::handle offset, const std::vector<double>& height) {
  return pliant::references::parts_of(row.data(), row.size(), offset, height);
}

}  // namespace

NB_MODULE(_references, m) {
  pliant::agree(m, "_references");
  pliant::import_numpy();
  m.doc() = "Functions of time that a loop asks for in each tick.";
  nb::class_<Spline>(m, "Spline")
      .def("__init__", &build, nb::keep_alive<1, 4>(), "times"_a, "step"_a, "pieces"_a.noconvert(), "first"_a, "last"_a)
      .def("at", &at, "time"_a, "out"_a.noconvert())
      .def("rows", &rows, "times"_a, "out"_a.noconvert());
  nb::class_<RowsAhead>(m, "RowsAhead")
      .def(nb::init<nb::object, double>(), "rows"_a, "rounding"_a)
      .def("row", &row, "time"_a, "period"_a)
      .def("task", &task, "time"_a, "period"_a, "offset"_a.none(), "height"_a)
      .def("fill", &pliant::references::fill, "table"_a.noconvert(), "begin"_a, "end"_a, "times"_a, "start"_a,
           "period"_a, "offset"_a.none(), "heights"_a)
      .def("preview", &pliant::references::preview, "time"_a, "nodes"_a, "start"_a, "period"_a, "offset"_a.none(),
           "heights"_a, "turning"_a, "width"_a);
  m.def("parts_of", &parts, "row"_a, "offset"_a.none(), "height"_a);
  m.def("columns_of", &pliant::references::columns_of, "times"_a, "table"_a, "turning"_a);
  m.def("superposed", &pliant::references::superposed, "base"_a, "pieces"_a, "time"_a, "width"_a);
  m.def("turning", &pliant::references::turning, "base"_a, "pieces"_a, "time"_a, "step"_a);
  pliant::references::bind_exploration(m);
}
