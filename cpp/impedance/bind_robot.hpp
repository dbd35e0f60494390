// A stack on a robot: estimate and references in, where the frames are and how the joints move them found here.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "../shared/python_signals.hpp"
#include "../shared/tree.hpp"
#include "bind_inputs.hpp"

namespace pliant::impedance {

struct Names {
  PyObject* frame = PyUnicode_InternFromString("frame");
  PyObject* q = PyUnicode_InternFromString("q");
  PyObject* position = PyUnicode_InternFromString("position");
  PyObject* rotation = PyUnicode_InternFromString("rotation");
  PyObject* modes = PyUnicode_InternFromString("modes");
  PyObject* tuning = PyUnicode_InternFromString("tuning");
};
inline const Names& names() {
  static const Names found;
  return found;
}

// The frames of a stack's tasks on a robot.
class Arm {
 public:
  Arm(nb::object robot, std::vector<nb::str> frames)
      : owner_(std::move(robot)), tree_(nb::cast<const bodies::Tree&>(owner_)), names_(std::move(frames)) {
    for (const nb::str& name : names_) frames_.push_back(tree_.frame(name.c_str()));
    bodies_.resize(size_t(tree_.n()));
    J_.resize(6 * bodies_.size());
    axes_.resize(9 * frames_.size());
  }

  int n() const { return tree_.n(); }
  int frames() const { return int(frames_.size()); }
  const nb::str& name(int frame) const { return names_[size_t(frame)]; }
  double* axes(int frame) { return axes_.data() + 9 * frame; }

  // Moves the robot to q (n); writes where the frames are. Returns J (6, n), column by column, at the world's origin.
  const double* place(const double* q, Stack& stack) {
    tree_.place(q, bodies_.data());
    for (int i = 0; i < frames(); ++i) {
      const bodies::Pose found = tree_.pose_of(frames_[size_t(i)], bodies_.data());
      Pose& actual = stack.input()[size_t(i)].actual;
      store(found.p, actual.position);
      std::copy(found.R, found.R + 9, actual.rotation);
      actual.oriented = stack.axes(i) == 6;
    }
    for (int j = 0; j < n(); ++j) {
      const bodies::Screw motion = tree_.motion(j, bodies_[size_t(j)]);
      store(motion.linear, J_.data() + 6 * j);
      store(motion.angular, J_.data() + 6 * j + 3);
    }
    return J_.data();
  }

 private:
  nb::object owner_;
  const bodies::Tree& tree_;
  std::vector<nb::str> names_;
  std::vector<bodies::Frame> frames_;
  std::vector<bodies::Body> bodies_;  // scratch space
  std::vector<double> J_;
  std::vector<double> axes_;  // of each task, row-major
};

// Copies an array of this shape, row by row, whatever the steps between its numbers.
inline void copy_array(nb::handle value, const char* name, std::initializer_list<long> shape, double* to) {
  PyArrayObject* array = doubles_of(value);
  const int ndim = int(shape.size());
  bool plain = array && PyArray_NDIM(array) == ndim;
  int axis = 0;
  for (const long size : shape) plain = plain && PyArray_DIMS(array)[axis++] == size;
  if (plain) {
    const npy_intp *sizes = PyArray_DIMS(array), *steps = PyArray_STRIDES(array);
    const long rows = ndim > 1 ? long(sizes[0]) : 1, columns = long(sizes[ndim - 1]);
    const npy_intp row = ndim > 1 ? steps[0] : 0, step = steps[ndim - 1];
    for (long i = 0; i < rows; ++i)
      for (long j = 0; j < columns; ++j)
        *to++ = *reinterpret_cast<const double*>(PyArray_BYTES(array) + i * row + j * step);
    return;
  }
  if (!PyObject_CheckBuffer(value.ptr())) throw nb::type_error("must be an array");
  Numbers numbers;  // of another type, or a shape that it refuses
  const Rows rows = numbers.read(value, name, shape);
  const long columns = *(shape.end() - 1), count = shape.size() > 1 ? *shape.begin() : 1;
  for (long i = 0; i < count; ++i) to = std::copy(rows.row(int(i)), rows.row(int(i)) + columns, to);
}

// Where the reference has a frame, and in which axes. False: not finite.
inline bool read_target(nb::handle target, bool six, TaskInput& in, double* axes) {
  copy_array(read_attribute(target, names().position), "a position", {3}, in.desired.position);
  const nb::object rotation = six ? read_attribute(target, names().rotation) : nb::none();
  in.desired.oriented = !rotation.is_none();
  if (in.desired.oriented) copy_array(rotation, "a rotation", {3, 3}, in.desired.rotation);
  in.axes = in.retune = nullptr;
  const nb::object modes = read_attribute(target, names().modes);
  if (!modes.is_none()) {
    copy_array(read_attribute(modes, names().rotation), "axes", {3, 3}, axes);
    if (!finite(axes, 9)) reject("axes must be finite");
    in.axes = axes;
  }
  return finite(in.desired);
}

// Whether references are of the arm's frames in turn, with the tuning, the axes' modes and the presence of a rotation
// that were seen before: (tuning, modes, whether there is no rotation) each.
inline bool as_seen(const Arm& arm, nb::tuple targets, nb::tuple seen) {
  if (int(targets.size()) != arm.frames()) return false;
  expect(seen.size(), arm.frames(), "seen");
  for (int i = 0; i < arm.frames(); ++i) {
    const nb::handle target = targets[size_t(i)];
    const auto one = nb::cast<nb::tuple>(seen[size_t(i)]);
    expect(one.size(), 3, "what was seen of a task");
    const nb::handle turns = read_attribute(target, names().rotation).is_none() ? Py_True : Py_False;
    if (!same_text(read_attribute(target, names().frame), arm.name(i)) || !turns.is(one[2]) ||
        !read_attribute(target, names().tuning).is(one[0]) || !read_attribute(target, names().modes).is(one[1]))
      return false;
  }
  return true;
}

// 0, or which input is not finite: 1 for q, 200 + i for the reference of task i; -1: not as it was seen.
inline int step_on(Stack& stack, Arm& arm, Vector memory, Vector out, nb::handle estimate, nb::tuple targets,
                   nb::object seen, nb::handle bias, nb::handle retune) {
  const int n = stack.joints();
  expect(memory.shape(0), stack.state_size(), "memory");
  expect(out.shape(0), stack.output_size(), "out");
  if (arm.n() != n || arm.frames() != stack.tasks()) reject("the arm belongs to another stack");
  if (!seen.is_none() && !as_seen(arm, targets, nb::cast<nb::tuple>(seen))) return -1;
  expect(targets.size(), stack.tasks(), "targets");
  Numbers numbers;
  const double* q = numbers.vector(read_attribute(estimate, names().q), "q", n);
  if (!finite(q, n)) return 1;
  for (int i = 0; i < stack.tasks(); ++i)
    if (!read_target(targets[size_t(i)], stack.axes(i) == 6, stack.input()[size_t(i)], arm.axes(i))) return 200 + i;
  const double* J = arm.place(q, stack);
  ConstVector kept;
  const double* added = read_bias(bias, n, kept);
  read_changes(stack, retune);
  stack.step(memory.data(), out.data(), q, J, added, stack.input());
  return 0;
}

}  // namespace pliant::impedance
