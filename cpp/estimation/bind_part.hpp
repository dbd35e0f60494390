// A chain of estimators as a part of a loop without Python.
#pragma once
#include <utility>

#include "../shared/part.hpp"
#include "bind_chain.hpp"

namespace pliant::estimation {

// Where a measurement stands in a tick's row: its time, joint signals and the wrenches of all sensors in turn.
struct MeasuredAt {
  int time, q, v, torque, torque_sent, wrenches;
};

class ChainPart final : public Part {
 public:
  ChainPart(const Chain::Stages& stages, int n, Names frames, MeasuredAt from, int begin)
      : core_(stages, n, std::move(frames)), from_(from), begin_(begin) {}

  int memory_size() const override { return core_.memory_size(); }
  bool step(double* row, double* memory) override {
    const Reading reading{row[from_.time],    row + from_.q,           row + from_.v,
                          row + from_.torque, row + from_.torque_sent, row + from_.wrenches};
    return core_.step(reading, row + begin_, memory).fault == Fault::none;
  }

 private:
  Chain core_;
  MeasuredAt from_;
  int begin_;
};

inline void build_part(ChainPart* self, const Chain::Stages& stages, int n, const std::vector<std::string>& frames,
                       const std::vector<int>& from, int begin) {
  if (from.size() != 6) throw std::invalid_argument("a measurement has six places");
  new (self) ChainPart(stages, n, frames, {from[0], from[1], from[2], from[3], from[4], from[5]}, begin);
}

inline void bind_part(nb::module_& m) {
  nb::module_::import_("pliant._loop");
  nb::class_<ChainPart, Part>(m, "ChainPart")
      .def("__init__", &build_part, "stages"_a, "n"_a, "frames"_a, "measured"_a, "begin"_a);
}

}  // namespace pliant::estimation
