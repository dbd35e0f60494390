// Python face of a chain of estimators: signals of src/pliant/signals.py in, rows of numbers out.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bind_stages.hpp"
#include "chain.hpp"

namespace pliant::estimation {

// Names of attributes, made once; reading an attribute by a C string would make a string each time.
struct SignalNames {
  PyObject* q = PyUnicode_InternFromString("q");
  PyObject* time = PyUnicode_InternFromString("time");
  PyObject* torque = PyUnicode_InternFromString("torque");
  PyObject* torque_sent = PyUnicode_InternFromString("torque_sent");
  PyObject* v = PyUnicode_InternFromString("v");
  PyObject* wrenches = PyUnicode_InternFromString("wrenches");
};
inline const SignalNames& signal_names() {
  static const SignalNames found;
  return found;
}

class PyChain {
 public:
  PyChain(const Chain::Stages& stages, int n, const std::vector<nb::str>& frames, bool completes)
      : core_(stages, n, names_of(frames)), frames_(frames), completes_(completes) {
    wrenches_.resize(6 * frames.size());
  }

  const Chain& core() const { return core_; }

  // None, or (fault, a, b). What is completed stands in `estimate`, None where the chain begins with the measurement.
  nb::object init(nb::handle measurement, nb::handle estimate, const Row& memory, const Row& out) {
    return run(measurement, estimate, memory, out, true);
  }
  nb::object step(nb::handle measurement, nb::handle estimate, const Row& memory, const Row& out) {
    return run(measurement, estimate, memory, out, false);
  }

 private:
  Chain core_;
  std::vector<nb::str> frames_;
  bool completes_;                // somebody else's estimates
  std::vector<double> wrenches_;  // of the sensors, scratch space

  static constexpr const char* fault_names[] = {"none", "out_of_order", "moves_while_tared"};

  static Names names_of(const std::vector<nb::str>& frames) {
    Names found;
    for (const nb::str& name : frames) found.emplace_back(name.c_str());
    return found;
  }

  void read_wrenches(nb::handle signal, double* rows) const {
    if (frames_.empty()) return;
    const nb::object wrenches = read_attribute(signal, signal_names().wrenches);
    if (nb::len(wrenches) != frames_.size())
      throw std::invalid_argument("a signal must have wrenches of " + std::to_string(frames_.size()) +
                                  " frames as the first one, got " + std::to_string(nb::len(wrenches)));
    for (size_t i = 0; i < frames_.size(); ++i) {
      const nb::object wrench = found_in(wrenches, frames_[i]);
      if (!wrench.is_valid())
        throw std::invalid_argument("a signal lacks the wrench of frame '" + std::string(frames_[i].c_str()) +
                                    "', which the first one had");
      Numbers numbers;
      const double* six = numbers.vector(wrench, "a wrench", 6);
      std::copy(six, six + 6, rows + 6 * i);
    }
  }
  void read_estimate(nb::handle estimate, double* out) const {
    const long n = core_.n();
    const std::pair<PyObject*, double*> fields[] = {
        {signal_names().q, out}, {signal_names().v, out + n}, {signal_names().torque, out + 2 * n}};
    for (const auto& [name, to] : fields) {
      Numbers numbers;
      const double* from = numbers.vector(read_attribute(estimate, name), "an estimate's joint signal", n);
      std::copy(from, from + n, to);
    }
    read_wrenches(estimate, core_.belief(out).wrenches);
  }

  nb::object run(nb::handle measurement, nb::handle estimate, const Row& memory, const Row& out, bool first) {
    if (memory.size() != size_t(core_.memory_size()))
      throw std::invalid_argument("this state belongs to another chain of estimators");
    if (out.size() != size_t(core_.belief_size())) throw std::invalid_argument("out must have belief_size entries");
    const long n = core_.n();
    Numbers numbers[4];
    const auto joints = [&](int slot, PyObject* name) {
      return numbers[slot].vector(read_attribute(measurement, name), "a measurement's joint signal", n);
    };
    Reading reading{};
    reading.time = nb::cast<double>(read_attribute(measurement, signal_names().time));
    reading.q = joints(0, signal_names().q);
    reading.v = joints(1, signal_names().v);
    reading.torque = joints(2, signal_names().torque);
    reading.torque_sent = joints(3, signal_names().torque_sent);
    if (completes_) {
      read_estimate(estimate, out.data());
    } else {
      read_wrenches(measurement, wrenches_.data());
      reading.wrenches = wrenches_.data();
    }
    const Refusal refusal =
        first ? core_.init(reading, out.data(), memory.data()) : core_.step(reading, out.data(), memory.data());
    if (refusal.fault == Fault::none) return nb::none();
    return nb::make_tuple(fault_names[int(refusal.fault)], refusal.values[0], refusal.values[1]);
  }
};

inline void bind_chain(nb::module_& m) {
  nb::class_<PyChain>(m, "Chain")
      .def(nb::init<const Chain::Stages&, int, const std::vector<nb::str>&, bool>(), "stages"_a, "n"_a, "frames"_a,
           "completes"_a)
      .def_prop_ro("frames", [](const PyChain& c) { return c.core().frames(); })
      .def_prop_ro("rows", [](const PyChain& c) { return c.core().rows(); })
      .def_prop_ro("memory_size", [](const PyChain& c) { return c.core().memory_size(); })
      .def_prop_ro("belief_size", [](const PyChain& c) { return c.core().belief_size(); })
      .def("init", &PyChain::init, "measurement"_a, "estimate"_a.none(), "memory"_a.noconvert(), "out"_a.noconvert())
      .def("step", &PyChain::step, "measurement"_a, "estimate"_a.none(), "memory"_a.noconvert(), "out"_a.noconvert());
}

}  // namespace pliant::estimation
