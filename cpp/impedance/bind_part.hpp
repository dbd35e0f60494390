// A stack on a robot as a part of a loop without Python.
#pragma once
#include <utility>
#include <vector>

#include "../shared/part.hpp"
#include "bind_robot.hpp"

namespace pliant::impedance {

// Where a task's reference stands in a tick's row.
struct Target {
  int position = 0;
  int rotation = -1;          // -1: it does not change
  std::vector<double> fixed;  // that one, row by row; empty: the orientation is free
};

class StackPart final : public Part {
 public:
  StackPart(const Stack& stack, const Arm& arm, int q, std::vector<Target> targets, int begin)
      : stack_(stack), arm_(arm), q_(q), targets_(std::move(targets)), begin_(begin) {
    for (size_t i = 0; i < targets_.size(); ++i) {
      Pose& desired = stack_.input()[i].desired;
      const Target& target = targets_[i];
      desired.oriented = stack_.axes(int(i)) == 6 && (target.rotation >= 0 || !target.fixed.empty());
      std::copy(target.fixed.begin(), target.fixed.end(), desired.rotation);
      stack_.input()[i].axes = stack_.input()[i].retune = nullptr;
    }
  }

  int memory_size() const override { return stack_.state_size(); }
  bool step(double* row, double* memory) override {
    const double* q = row + q_;
    if (!finite(q, stack_.joints())) return false;
    for (size_t i = 0; i < targets_.size(); ++i) {
      const Target& target = targets_[i];
      Pose& desired = stack_.input()[i].desired;
      std::copy(row + target.position, row + target.position + 3, desired.position);
      if (target.rotation >= 0) std::copy(row + target.rotation, row + target.rotation + 9, desired.rotation);
      if (!finite(desired)) return false;
    }
    const double* J = arm_.place(q, stack_);
    stack_.step(memory, row + begin_, q, J, nullptr, stack_.input());
    return true;
  }
  void kept_back(double* memory, const double* torque) const override {
    for (int j = 0; j < stack_.joints(); ++j) memory[stack_.kept_back() + j] += torque[j];
  }

 private:
  Stack stack_;
  Arm arm_;
  int q_;
  std::vector<Target> targets_;
  int begin_;
};

// targets: where position and rotation begin (-1: fixed), and the fixed rotation (9), or nothing.
using TargetRow = std::tuple<int, int, std::vector<double>>;

inline void build_part(StackPart* self, const Stack& stack, const Arm& arm, int q, const std::vector<TargetRow>& rows,
                       int begin) {
  if (arm.n() != stack.joints() || arm.frames() != stack.tasks()) reject("the arm belongs to another stack");
  expect(rows.size(), stack.tasks(), "targets");
  std::vector<Target> targets;
  for (const auto& [position, rotation, fixed] : rows) {
    if (!fixed.empty()) expect(fixed.size(), 9, "a rotation");
    targets.push_back({position, rotation, fixed});
  }
  new (self) StackPart(stack, arm, q, std::move(targets), begin);
}

inline void bind_part(nb::module_& m) {
  nb::module_::import_("pliant._loop");
  nb::class_<StackPart, Part>(m, "StackPart")
      .def("__init__", &build_part, nb::arg("stack"), nb::arg("arm"), nb::arg("q"), nb::arg("targets"),
           nb::arg("begin"));
}

}  // namespace pliant::impedance
