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

// What a controller asked for, and where its joints are.
struct CommandRow {
  const double *torque, *clamped, *q;
  const double* channels;  // null: they are no numbers in a row
  int size;                // of them
};

// One step. `out` gets the torque and the clamped torque, (n) each; where the controller's channels are numbers in a
// row, these, the energy that the bound withheld [J] and by how much it is exceeded. Returns whether a part was held
// back. spendable() [J] is asked for only then.
template <class Spendable>
bool limited(const StepLimit& limit, const CommandRow& asked, const Spendable& spendable, double* memory, double* out,
             double& exceeded) {
  const int n = limit.n();
  double* taken = out + n;
  const StepLimit::Outcome outcome = limit.step(asked.torque, asked.q, memory, out);
  exceeded = outcome.held_back ? limit.give_way(outcome, spendable(), asked.torque, memory, out) : 0;
  const double* held = limit.held_back(memory);
  for (int j = 0; j < n; ++j) taken[j] = asked.clamped[j] + held[j];
  limit.keep(out, memory);
  if (asked.channels) {
    double* last = std::copy(asked.channels, asked.channels + asked.size, taken + n);
    last[0] = limit.energy(memory);
    last[1] = exceeded;
  }
  return outcome.held_back;
}

// None: nothing was held back; else by how much the bound is exceeded.
inline std::optional<double> step_limit(const StepLimit& limit, nb::handle torque, nb::handle clamped, nb::handle q,
                                        nb::handle diagnostics, const nb::str& channel,
                                        const std::optional<ConstRow>& channels, const Row& memory, const Row& out) {
  const long n = limit.n();
  const size_t more = channels ? channels->size() + 2 : 0;
  if (memory.size() != size_t(limit.memory_size())) throw std::invalid_argument("memory must have memory_size entries");
  if (out.size() != size_t(2 * n) + more)
    throw std::invalid_argument("out must have two entries per joint, and two more than the channels");
  Numbers numbers[3];
  const CommandRow asked{numbers[0].vector(torque, "torque", n), numbers[1].vector(clamped, "clamped", n),
                         numbers[2].vector(q, "q", n), channels ? channels->data() : nullptr,
                         channels ? int(channels->size()) : 0};
  double exceeded = 0;
  const auto spendable = [&] { return spendable_of(diagnostics, channel); };
  return limited(limit, asked, spendable, memory.data(), out.data(), exceeded) ? std::optional(exceeded) : std::nullopt;
}

inline void bind_step_limit(nb::module_& m) {
  nb::class_<StepLimit>(m, "StepLimit")
      .def(nb::init<std::vector<double>>(), "step_max"_a)
      .def_prop_ro("memory_size", &StepLimit::memory_size)
      .def("step", &step_limit, "torque"_a, "clamped"_a, "q"_a, "diagnostics"_a, "channel"_a, "channels"_a.none(),
           "memory"_a.noconvert(), "out"_a.noconvert());
}

}  // namespace pliant::guard
