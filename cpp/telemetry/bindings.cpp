// Extension module pliant._telemetry.
#include "row.hpp"

namespace {

using namespace pliant;
using pliant::telemetry::Row;

int fill(const Row& row, nb::handle tick, const Packed<double, 2>& rows, size_t index) {
  if (index >= rows.shape(0) || rows.shape(1) != size_t(row.width()))
    throw std::invalid_argument("there is no such row of this width");
  return row.fill(tick, rows.data() + index * rows.shape(1));
}

}  // namespace

NB_MODULE(_telemetry, m) {
  nb::class_<Row>(m, "Row")
      .def(nb::init<nb::object>(), "flat"_a)
      .def("mapping", &Row::mapping, "path"_a, "keys"_a)
      .def("items", &Row::items, "path"_a, "count"_a)
      .def("none", &Row::none, "path"_a)
      .def("text", &Row::text, "path"_a, "said"_a)
      .def("array", &Row::array, "path"_a, "offset"_a, "size"_a)
      .def("number", &Row::number, "path"_a, "offset"_a)
      .def_prop_ro("width", &Row::width)
      .def("fill", &fill, "tick"_a, "rows"_a.noconvert(), "index"_a);
}
