// Extension module pliant._guard. Every function answers whether a signal is
// sound beyond doubt; where it says no, src/pliant/guard/sound.py finds out
// what is wrong, or that nothing is.
#include "../shared/contract.hpp"
#include "bind_step_limit.hpp"
#include "bind_step_limit_part.hpp"
#include "numbers.hpp"

namespace {

using namespace pliant;
using pliant::guard::Look;

// Names of attributes, made once; reading an attribute by a C string would make
// a string each time.
#define PLIANT_NAME(name) PyObject* name = PyUnicode_InternFromString(#name)
struct Fields {
  PLIANT_NAME(acceleration);
  PLIANT_NAME(clamped);
  PLIANT_NAME(damping);
  PLIANT_NAME(damping_std);
  PLIANT_NAME(disturbance);
  PLIANT_NAME(environments);
  PLIANT_NAME(frame);
  PLIANT_NAME(position);
  PLIANT_NAME(posture);
  PLIANT_NAME(preview);
  PLIANT_NAME(q);
  PLIANT_NAME(rotation);
  PLIANT_NAME(stiffness);
  PLIANT_NAME(stiffness_std);
  PLIANT_NAME(surfaces);
  PLIANT_NAME(task_rotation);
  PLIANT_NAME(tasks);
  PLIANT_NAME(time);
  PLIANT_NAME(torque);
  PLIANT_NAME(torque_sent);
  PLIANT_NAME(v);
  PLIANT_NAME(velocity);
  PLIANT_NAME(wrench);
  PLIANT_NAME(wrenches);
};
#undef PLIANT_NAME
const Fields& fields() {
  static const Fields found;
  return found;
}

// A field; none where there is no such field.
nb::object field(nb::handle signal, PyObject* name, Look& look) {
  PyObject* value = PyObject_GetAttr(signal.ptr(), name);
  if (value) return nb::steal(value);
  PyErr_Clear();
  look.refuse();
  return nb::none();
}

void joints(nb::handle signal, long n, Look& look) {
  const Fields& f = fields();
  look.time(field(signal, f.time, look));
  for (PyObject* name : {f.q, f.v, f.torque, f.torque_sent}) look.array(field(signal, name, look), {n});
}

bool is_empty(nb::handle mapping) {
  const Py_ssize_t size = PyObject_Size(mapping.ptr());
  if (size < 0) PyErr_Clear();
  return size == 0;
}

// Every wrench of a mapping; its frames are these, in this order, if `frames`
// is given.
void wrenches(nb::handle mapping, PyObject* frames, Look& look) {
  if (!PyDict_CheckExact(mapping.ptr())) {
    if (!is_empty(mapping) || (frames && PyTuple_GET_SIZE(frames) != 0)) look.refuse();
    return;
  }
  if (frames && PyDict_Size(mapping.ptr()) != PyTuple_GET_SIZE(frames)) return look.refuse();
  Py_ssize_t at = 0;
  for (Py_ssize_t i = 0;; ++i) {
    PyObject *key, *value;
    if (!PyDict_Next(mapping.ptr(), &at, &key, &value)) return;
    if (frames && !same_text(key, PyTuple_GET_ITEM(frames, i))) return look.refuse();
    look.array(value, {6});
  }
}

bool is_reading(nb::handle reading, long n, nb::tuple frames) {
  Look look;
  joints(reading, n, look);
  if (look.good()) wrenches(field(reading, fields().wrenches, look), frames.ptr(), look);
  return look.good();
}

double number(nb::handle of, PyObject* name, Look& look) {
  const nb::object value = field(of, name, look);
  if (PyFloat_CheckExact(value.ptr())) return PyFloat_AS_DOUBLE(value.ptr());
  look.refuse();
  return 0;
}

// Finite stiffness and damping; an uncertainty may be infinite.
void environments(nb::handle mapping, Look& look) {
  const Fields& f = fields();
  if (!PyDict_CheckExact(mapping.ptr())) {
    if (!is_empty(mapping)) look.refuse();
    return;
  }
  Py_ssize_t at = 0;
  PyObject *key, *known;
  while (PyDict_Next(mapping.ptr(), &at, &key, &known)) {
    const double sum = number(known, f.stiffness, look) + number(known, f.damping, look);
    const bool certain = number(known, f.stiffness_std, look) >= 0 && number(known, f.damping_std, look) >= 0;
    if (!certain || !std::isfinite(sum)) return look.refuse();
  }
}

void preview(nb::handle ahead, long n, Look& look) {
  const Fields& f = fields();
  const nb::object time = field(ahead, f.time, look);
  const Py_ssize_t size = PyObject_Size(time.ptr());
  if (size < 0) {
    PyErr_Clear();
    return look.refuse();
  }
  const long N = long(size);
  look.array(time, {N});
  look.array(field(ahead, f.position, look), {N, 3});
  for (PyObject* name : {f.velocity, f.wrench}) look.array(field(ahead, name, look), {N, 6});
  for (PyObject* name : {f.rotation, f.task_rotation}) look.optional(field(ahead, name, look), {N, 3, 3});
  look.optional(field(ahead, f.posture, look), {N, n});
}

bool is_estimate(nb::handle estimate, long n) {
  const Fields& f = fields();
  Look look;
  joints(estimate, n, look);
  if (!look.good()) return false;
  look.optional(field(estimate, f.disturbance, look), {n});
  wrenches(field(estimate, f.wrenches, look), nullptr, look);
  environments(field(estimate, f.environments, look), look);
  if (!is_empty(field(estimate, f.surfaces, look))) look.refuse();
  return look.good();
}

bool is_reference(nb::handle reference, long n) {
  const Fields& f = fields();
  Look look;
  look.time(field(reference, f.time, look));
  look.optional(field(reference, f.posture, look), {n});
  if (const nb::object ahead = field(reference, f.preview, look); !ahead.is_none()) preview(ahead, n, look);
  const nb::object tasks = field(reference, f.tasks, look);
  if (!look.good() || !PyTuple_CheckExact(tasks.ptr())) return false;
  for (Py_ssize_t i = 0; i < PyTuple_GET_SIZE(tasks.ptr()); ++i) {
    const nb::handle task = PyTuple_GET_ITEM(tasks.ptr(), i);
    if (!PyUnicode_Check(field(task, f.frame, look).ptr())) return false;
    look.array(field(task, f.position, look), {3});
    for (PyObject* name : {f.velocity, f.acceleration, f.wrench}) look.array(field(task, name, look), {6});
    for (PyObject* name : {f.rotation, f.task_rotation}) look.optional(field(task, name, look), {3, 3});
  }
  return look.good();
}

// With a bound given, no torque may be larger than it.
bool is_command(nb::handle command, long n, nb::handle bound) {
  const Fields& f = fields();
  Look look;
  look.time(field(command, f.time, look));
  const nb::object torque = field(command, f.torque, look);
  look.array(torque, {n});
  look.array(field(command, f.clamped, look), {n});
  if (!look.good()) return false;
  if (bound.is_none()) return true;
  Numbers numbers[2];
  const double* sent = numbers[0].vector(torque, "torque", n);
  const double* limit = numbers[1].vector(bound, "bound", n);
  for (long j = 0; j < n; ++j)
    if (!(std::abs(sent[j]) <= limit[j])) return false;
  return true;
}

}  // namespace

NB_MODULE(_guard, m) {
  pliant::agree(m, "_guard");
  m.def("is_reading", &is_reading, "reading"_a, "n"_a, "frames"_a);
  m.def("is_estimate", &is_estimate, "estimate"_a, "n"_a);
  m.def("is_reference", &is_reference, "reference"_a, "n"_a);
  m.def("is_command", &is_command, "command"_a, "n"_a, "bound"_a.none());
  pliant::guard::bind_step_limit(m);
  pliant::guard::bind_step_limit_part(m);
}
