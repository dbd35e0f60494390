// Extension module pliant._loop: blocks of ticks without Python, and the classes that parts of them are.
#include <nanobind/stl/pair.h>
#include <nanobind/stl/vector.h>

#include <stdexcept>

#include "../shared/contract.hpp"
#include "../shared/numpy_arrays.hpp"
#include "block.hpp"

namespace {

using namespace nanobind::literals;
namespace nb = nanobind;
using namespace pliant;
using pliant::loop::Block;
using SpanRow = std::pair<int, int>;

std::vector<Span> within(const std::vector<SpanRow>& rows, int width) {
  std::vector<Span> found;
  for (const auto& [begin, size] : rows) {
    if (begin < 0 || size < 0 || begin + size > width) throw std::invalid_argument("a span must lie within the row");
    found.push_back({begin, size});
  }
  return found;
}

void build(Block* self, int width, Part& estimator, Part& controller, World& world,
           const std::vector<SpanRow>& measured, const std::vector<SpanRow>& estimated,
           const std::vector<SpanRow>& made, const std::vector<SpanRow>& drawn, std::vector<int> unknown, int torque,
           std::vector<double> most) {
  for (const int place : unknown) within({{place, 1}}, width);
  within({{torque, int(most.size())}}, width);
  new (self) Block({width, within(measured, width), within(estimated, width), within(made, width), within(drawn, width),
                    std::move(unknown), torque, std::move(most)},
                   estimator, controller, world);
}

nb::tuple run(Block& block, const Packed<double, 2>& rows, int ticks, const Packed<double, 1>& memory,
              const Packed<double, 2>& wall) {
  if (ticks < 0 || rows.shape(0) < size_t(ticks) + 1 || rows.shape(1) != size_t(block.width()))
    throw std::invalid_argument("there must be a row for every tick and one more, of the block's width");
  if (memory.size() != size_t(block.memory_size())) throw std::invalid_argument("memory must have memory_size entries");
  if (wall.shape(0) < size_t(ticks) || wall.shape(1) != 2)
    throw std::invalid_argument("there must be two times for every tick");
  double *numbers = rows.data(), *remembered = memory.data(), *times = wall.data();
  loop::Ran ran;
  {
    nb::gil_scoped_release release;
    ran = block.run(numbers, ticks, remembered, times);
  }
  return nb::make_tuple(ran.ticks, ran.stopped);
}

}  // namespace

NB_MODULE(_loop, m) {
  pliant::agree(m, "_loop");
  m.doc() = "Blocks of ticks of a control loop whose parts are all compiled.";
  nb::class_<Part>(m, "Part").def_prop_ro("memory_size", &Part::memory_size);
  nb::class_<World>(m, "World");
  nb::class_<Block>(m, "Block")
      .def("__init__", &build, "width"_a, "estimator"_a, "controller"_a, "world"_a, "measured"_a, "estimated"_a,
           "made"_a, "drawn"_a, "unknown"_a, "torque"_a, "most"_a, nb::keep_alive<1, 3>(), nb::keep_alive<1, 4>(),
           nb::keep_alive<1, 5>())
      .def_prop_ro("memory_size", &Block::memory_size)
      .def("run", &run, "rows"_a.noconvert(), "ticks"_a, "memory"_a.noconvert(), "wall"_a.noconvert());
}
