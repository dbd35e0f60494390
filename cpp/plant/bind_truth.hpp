// Python face of what is true of a simulated robot.
#pragma once
#include "bind_physics.hpp"
#include "truth.hpp"

namespace pliant::plant {

inline void init_truth(TruthRow* self, nb::handle model, Doubles lower, Doubles upper, std::vector<int> sites,
                       std::vector<int> bodies) {
  TruthRow made(std::move(lower), std::move(upper), std::move(sites), std::move(bodies));
  if (!made.fits(*pointed<const mjModel>(model)))
    throw std::invalid_argument("the model does not have these joints, sites or bodies");
  new (self) TruthRow(std::move(made));
}

inline void read_truth(const TruthRow& truth, nb::handle data, const Vector& out) {
  expect(out.size(), int(truth.size()), "out");
  truth.read(*pointed<const mjData>(data), out.data());
}

inline void bind_truth(nb::module_& m) {
  nb::class_<TruthRow>(m, "TruthRow")
      .def("__init__", &init_truth, "model"_a, "lower"_a, "upper"_a, "sites"_a, "bodies"_a)
      .def_prop_ro("size", &TruthRow::size)
      .def("read", &read_truth, "data"_a, "out"_a.noconvert());
}

}  // namespace pliant::plant
