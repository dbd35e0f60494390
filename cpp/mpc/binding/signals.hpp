// Signals of src/pliant/signals.py as the flat structs of a step: their arrays are read where they lie.
#pragma once
#include <array>

#include "../../shared/python_signals.hpp"
#include "../step/data.hpp"
#include "arrays.hpp"

namespace pliant::mpc::binding {

// Names of attributes, made once; reading an attribute by a C string would make a string each time.
struct Names {
  PyObject* contacts = PyUnicode_InternFromString("contacts");
  PyObject* disturbance = PyUnicode_InternFromString("disturbance");
  PyObject* environments = PyUnicode_InternFromString("environments");
  PyObject* frame = PyUnicode_InternFromString("frame");
  PyObject* phase = PyUnicode_InternFromString("phase");
  PyObject* position = PyUnicode_InternFromString("position");
  PyObject* posture = PyUnicode_InternFromString("posture");
  PyObject* preview = PyUnicode_InternFromString("preview");
  PyObject* q = PyUnicode_InternFromString("q");
  PyObject* rotation = PyUnicode_InternFromString("rotation");
  PyObject* stiffness = PyUnicode_InternFromString("stiffness");
  PyObject* damping = PyUnicode_InternFromString("damping");
  PyObject* damping_std = PyUnicode_InternFromString("damping_std");
  PyObject* task_rotation = PyUnicode_InternFromString("task_rotation");
  PyObject* tasks = PyUnicode_InternFromString("tasks");
  PyObject* time = PyUnicode_InternFromString("time");
  PyObject* torque = PyUnicode_InternFromString("torque");
  PyObject* v = PyUnicode_InternFromString("v");
  PyObject* velocity = PyUnicode_InternFromString("velocity");
  PyObject* wrench = PyUnicode_InternFromString("wrench");
  PyObject* wrenches = PyUnicode_InternFromString("wrenches");
};
inline const Names& names() {
  static const Names found;
  return found;
}
inline double read_time(nb::handle signal) { return nb::cast<double>(read_attribute(signal, names().time)); }

// What of an estimate a step looks at.
struct Looks {
  bool force, torque, disturbance;  // always, where the controller has them
  bool rest;                        // contact and environment, for a solve
  bool environment;
};

// An estimate, as a controller with this contact frame reads it.
class ReadEstimate {
 public:
  step::Estimated data{};

  ReadEstimate(nb::handle estimate, double time, nb::handle frame, long n, const Looks& looks) {
    data.time = time;
    data.contact = -1;
    data.stiffness = -1;
    data.q = numbers_[0].vector(read_attribute(estimate, names().q), "the estimate's q", n);
    data.v = numbers_[1].vector(read_attribute(estimate, names().v), "the estimate's v", n);
    if (looks.torque)
      data.torque = numbers_[2].vector(read_attribute(estimate, names().torque), "the estimate's torque", n);
    if (looks.force || looks.rest)
      if (const nb::object wrench = found_in(read_attribute(estimate, names().wrenches), frame); wrench.is_valid())
        data.wrench = numbers_[3].vector(wrench, "the estimate's wrench", 6);
    if (looks.disturbance)
      if (const nb::object d = read_attribute(estimate, names().disturbance); !d.is_none())
        data.disturbance = numbers_[4].vector(d, "the estimate's disturbance", n);
    if (!looks.rest) return;
    const nb::object contact = found_in(read_attribute(estimate, names().contacts), frame);
    if (contact.is_valid()) data.contact = PyObject_IsTrue(contact.ptr());
    if (!looks.environment) return;
    if (const nb::object known = found_in(read_attribute(estimate, names().environments), frame); known.is_valid()) {
      data.stiffness = nb::cast<double>(read_attribute(known, names().stiffness));
      data.damping = nb::cast<double>(read_attribute(known, names().damping));
      data.damping_std = nb::cast<double>(read_attribute(known, names().damping_std));
    }
  }

 private:
  std::array<Numbers, 5> numbers_;
};

// A task's reference.
class ReadTask {
 public:
  step::Task data{};

  explicit ReadTask(nb::handle task) {
    data.position = numbers_[0].vector(read_attribute(task, names().position), "the reference's position", 3);
    data.velocity = numbers_[1].vector(read_attribute(task, names().velocity), "the reference's velocity", 6);
    data.wrench = numbers_[2].vector(read_attribute(task, names().wrench), "the reference's wrench", 6);
    data.rotation = matrix(read_attribute(task, names().rotation), 3, "the reference's rotation");
    data.task_rotation = matrix(read_attribute(task, names().task_rotation), 4, "the reference's task_rotation");
  }

 private:
  std::array<Numbers, 5> numbers_;

  const double* matrix(nb::handle value, size_t slot, const char* name) {
    if (value.is_none()) return nullptr;
    const step::Rows rows = numbers_[slot].read(value, name, {3, 3});
    if (rows.stride == 3) return rows.data;
    for (int i = 0; i < 3; ++i) std::memcpy(packed_[slot - 3] + 3 * i, rows.row(i), 3 * sizeof(double));
    return packed_[slot - 3];
  }
  double packed_[2][9];
};

// A preview; `phase_of` turns a name into an index.
class ReadPreview {
 public:
  template <class PhaseOf>
  void read(nb::handle preview, long n, PhaseOf phase_of, step::Ahead& ahead) {
    ahead.time = numbers_[0].read(read_attribute(preview, names().time), "the preview's time", {-1});
    const long count = numbers_[0].rows();
    if (count < 1) throw std::invalid_argument("a preview must have at least one instant, got none");
    ahead.count = int(count);
    ahead.position = numbers_[1].read(read_attribute(preview, names().position), "the preview's position", {count, 3});
    ahead.velocity = numbers_[3].read(read_attribute(preview, names().velocity), "the preview's velocity", {count, 6});
    ahead.wrench = numbers_[4].read(read_attribute(preview, names().wrench), "the preview's wrench", {count, 6});
    ahead.rotation = ahead.posture = ahead.task_rotation = {};
    if (const nb::object turns = read_attribute(preview, names().rotation); !turns.is_none())
      ahead.rotation = numbers_[2].read(turns, "the preview's rotation", {count, 3, 3});
    if (const nb::object posture = read_attribute(preview, names().posture); !posture.is_none())
      ahead.posture = numbers_[5].read(posture, "the preview's posture", {count, n});
    if (const nb::object axes = read_attribute(preview, names().task_rotation); !axes.is_none())
      ahead.task_rotation = numbers_[6].read(axes, "the preview's task_rotation", {count, 3, 3});
    ahead.phase.clear();
    for (nb::handle name : read_attribute(preview, names().phase)) ahead.phase.push_back(phase_of(name));
    if (!ahead.phase.empty() && long(ahead.phase.size()) != count)
      throw std::invalid_argument("a preview must have a phase for each of its " + std::to_string(count) +
                                  " instants, got " + std::to_string(ahead.phase.size()));
  }

 private:
  std::array<Numbers, 7> numbers_;
};

}  // namespace pliant::mpc::binding
