// Python face of the bound on torque steps; src/pliant/controllers/step_limit.py is its typed face.
#pragma once
#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/vector.h>

#include <optional>
#include <vector>

#include "../shared/python_signals.hpp"
#include "step_limit.hpp"

namespace pliant::guard {

using Row = Packed<double, 1>;
using ConstRow = Packed<const double, 1>;

// What a controller says may be spent in the next period [J]; without such a channel there is no end of it.
inline double spendable_of(nb::handle diagnostics, const nb::str& channel) {
  const int known = PySequence_Contains(diagnostics.ptr(), channel.ptr());
  if (known < 0) throw nb::python_error();
  if (!known) return HUGE_VAL;
  const nb::object value = nb::steal(PyObject_GetItem(diagnostics.ptr(), channel.ptr()));
  if (!value.is_valid()) throw nb::python_error();
  const double found = PyFloat_AsDouble(value.ptr());
  if (found == -1.0 && PyErr_Occurred()) throw nb::python_error();
  return found;
}

// `out` gets the torque and the clamped torque, (n) each; where the controller's channels are numbers in a row, these,
// the energy that the bound withheld [J] and by how much it is exceeded. None: nothing was held back; else the last of
// these.
inline std::optional<double> step_limit(const StepLimit& limit, nb::handle torque, nb::handle clamped, nb::handle q,
                                        nb::handle diagnostics, const nb::str& channel,
                                        const std::optional<ConstRow>& channels, const Row& memory, const Row& out) {
  const long n = limit.n();
  const size_t more = channels ? channels->size() + 2 : 0;
  if (memory.size() != size_t(limit.memory_size())) throw std::invalid_argument("memory must have memory_size entries");
  if (out.size() != size_t(2 * n) + more)
    throw std::invalid_argument("out must have two entries per joint, and two more than the channels");
  Numbers numbers[3];
  const double* wanted = numbers[0].vector(torque, "torque", n);
  const double* lost = numbers[1].vector(clamped, "clamped", n);
  double *sent = out.data(), *taken = sent + n;
  const StepLimit::Outcome outcome = limit.step(wanted, numbers[2].vector(q, "q", n), memory.data(), sent);
  const double exceeded =
      outcome.held_back ? limit.give_way(outcome, spendable_of(diagnostics, channel), wanted, memory.data(), sent) : 0;
  const double* held = limit.held_back(memory.data());
  for (long j = 0; j < n; ++j) taken[j] = lost[j] + held[j];
  limit.keep(sent, memory.data());
  if (channels) {
    double* last = std::copy(channels->data(), channels->data() + channels->size(), taken + n);
    last[0] = limit.energy(memory.data());
    last[1] = exceeded;
  }
  return outcome.held_back ? std::optional(exceeded) : std::nullopt;
}

inline void bind_step_limit(nb::module_& m) {
  nb::class_<StepLimit>(m, "StepLimit")
      .def(nb::init<std::vector<double>>(), "step_max"_a)
      .def_prop_ro("memory_size", &StepLimit::memory_size)
      .def("step", &step_limit, "torque"_a, "clamped"_a, "q"_a, "diagnostics"_a, "channel"_a, "channels"_a.none(),
           "memory"_a.noconvert(), "out"_a.noconvert());
}

}  // namespace pliant::guard
