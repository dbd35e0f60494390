// Extension module pliant._telemetry.
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <tuple>

#include "../shared/contract.hpp"
#include "pack.hpp"
#include "row.hpp"

namespace {

using namespace pliant;
using pliant::telemetry::Row;
using Bytes = nb::ndarray<uint8_t, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
using Times = nb::ndarray<const int64_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using RecordRow = std::tuple<int64_t, uint32_t, int64_t>;
using ColumnRow = std::tuple<nb::object, std::vector<int64_t>>;

int fill(const Row& row, nb::handle tick, const Packed<double, 2>& rows, size_t index) {
  if (index >= rows.shape(0) || rows.shape(1) != size_t(row.width()))
    throw std::invalid_argument("there is no such row of this width");
  return row.fill(tick, rows.data() + index * rows.shape(1));
}

void pack(nb::bytes shape, const std::vector<RecordRow>& records, const std::vector<ColumnRow>& columns, Times times,
          Bytes out) {
  const auto width = int64_t(shape.size());
  if (out.shape(0) != times.shape(0) || out.shape(1) != size_t(width))
    throw std::invalid_argument("there must be a row of the template's width for each time");
  std::vector<telemetry::Record> heads;
  for (const auto& [begin, first, stamp] : records) heads.push_back({begin, first, stamp});
  std::vector<telemetry::Column> numbers;
  std::vector<Numbers> kept(columns.size());
  for (size_t i = 0; i < columns.size(); ++i) {
    const auto& [values, places] = columns[i];
    const Rows rows = kept[i].read(values, "a channel", {long(times.shape(0)), long(places.size())});
    numbers.push_back({rows.data, long(rows.stride), places});
  }
  if (!telemetry::stands_within(heads, numbers, width)) throw std::invalid_argument("a place beyond the row");
  telemetry::pack(shape.c_str(), width, heads, numbers, times.data(), long(times.shape(0)),
                  reinterpret_cast<char*>(out.data()));
}

}  // namespace

NB_MODULE(_telemetry, m) {
  pliant::agree(m, "_telemetry");
  m.def("pack", &pack, "template"_a, "records"_a, "columns"_a, "times"_a, "out"_a.noconvert());
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
