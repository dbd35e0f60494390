// The bound on torque steps round a controller that is a part of a loop without Python.
#pragma once
#include "../shared/part.hpp"
#include "bind_step_limit.hpp"

namespace pliant::guard {

// Where the controller inside has its command in a tick's row.
struct CommandAt {
  int torque, clamped;
  Span channels;
  int spendable;  // -1: it does not say what may be spent
};

class StepLimitPart final : public Part {
 public:
  StepLimitPart(StepLimit limit, Part& inner, int q, CommandAt from, int begin)
      : limit_(std::move(limit)), inner_(inner), q_(q), from_(from), begin_(begin) {}

  // Its own numbers, then those of the controller inside.
  int memory_size() const override { return limit_.memory_size() + inner_.memory_size(); }
  void begin() override { inner_.begin(); }
  void rewind() override { inner_.rewind(); }
  bool step(double* row, double* memory) override {
    double* inside = memory + limit_.memory_size();
    if (!inner_.step(row, inside)) return false;
    const CommandRow command{row + from_.torque, row + from_.clamped, row + q_, row + from_.channels.begin,
                             from_.channels.size};
    const double spendable = from_.spendable < 0 ? HUGE_VAL : row[from_.spendable];
    double exceeded = 0;
    if (limited(limit_, command, [spendable] { return spendable; }, memory, row + begin_, exceeded))
      inner_.kept_back(inside, limit_.held_back(memory));
    return true;
  }

 private:
  StepLimit limit_;
  Part& inner_;
  int q_;
  CommandAt from_;
  int begin_;
};

inline void build_part(StepLimitPart* self, const StepLimit& limit, Part& inner, int q, const std::vector<int>& from,
                       int begin) {
  if (from.size() != 5) throw std::invalid_argument("a command has five places");
  new (self) StepLimitPart(limit, inner, q, {from[0], from[1], {from[2], from[3]}, from[4]}, begin);
}

inline void bind_step_limit_part(nb::module_& m) {
  nb::module_::import_("pliant._loop");
  nb::class_<StepLimitPart, Part>(m, "StepLimitPart")
      .def("__init__", &build_part, nb::keep_alive<1, 3>(), "limit"_a, "inner"_a, "q"_a, "command"_a, "begin"_a);
}

}  // namespace pliant::guard
