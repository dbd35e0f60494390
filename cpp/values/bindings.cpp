// Extension module pliant._values.
#include "../shared/contract.hpp"
#include "changer.hpp"
#include "maker.hpp"
#include "views.hpp"

using namespace pliant::values;
using namespace nb::literals;

NB_MODULE(_values, m) {
  pliant::agree(m, "_values");
  m.doc() = "Frozen values made in one call, and views of one array.";
  pliant::import_numpy();
  m.def("make_by_slots", &make_by_slots, "kind"_a, "fields"_a, "absent"_a);
  m.def("changed", &changed, "value"_a, "fields"_a);
  nb::class_<Views>(m, "Views")
      .def(nb::init<std::vector<Place>>(), "places"_a)
      .def_prop_ro("size", &Views::size)
      .def("of", &Views::of, "numbers"_a);
  nb::class_<NamedViews>(m, "NamedViews")
      .def(nb::init<std::vector<nb::str>, std::vector<Place>>(), "names"_a, "places"_a)
      .def("of", &NamedViews::of, "numbers"_a)
      .def("into", &NamedViews::into, "numbers"_a, "named"_a);
}
