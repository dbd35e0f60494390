// A predictive controller as a part of a loop without Python.
#pragma once
#include <nanobind/stl/map.h>
#include <nanobind/stl/string.h>

#include <map>
#include <memory>

#include "../../shared/part.hpp"
#include "step.hpp"

namespace pliant::mpc::binding {

// Where signals stand in a tick's row; -1: nowhere. The reference is that of the controlled frame, the only task.
struct PartPlaces {
  int time, q, v, torque, wrench, disturbance, contact, environment;              // stiffness, damping, its deviation
  int position, rotation, velocity, pressed, task_rotation, posture;              // of the reference
  int has_ahead, instants, positions, rotations, velocities, wrenches, postures;  // of the preview
  int task_rotations, phases;                                                     // phases: numbers of names
};

class StepPart final : public Part {
 public:
  StepPart(const PyStep& step, PyState& state, const PartPlaces& at, int count, int phase, std::vector<int> phases,
           int begin)
      : step_(step), state_(state), at_(at), count_(count), phase_(phase), phases_(std::move(phases)), begin_(begin) {
    ahead_.phase.resize(size_t(count));
  }

  void begin() override {
    const step::State& s = state_.state;
    memory_ = s.memory;
    series_ = s.series;
    kept_ = s.kept();
    source_ = state_.source;
  }
  void rewind() override {
    step::State& s = state_.state;
    s.memory = memory_;
    s.series = series_;
    s.restore(kept_);
    state_.source = source_;
  }
  bool step(double* row, double*) override {
    const step::Controller& core = step_.core();
    const step::Settings& settings = core.settings();
    step::State& s = state_.state;
    const double time = row[at_.time];
    const bool due = core.due(time, s);
    const step::Estimated e = estimated(row, due);
    step::Wanted wanted{};
    const bool looks = due || (settings.riccati && settings.model.axes == Axes::surface);
    if (due) read(row, wanted);
    step::Answer answer;
    try {
      const step::Refusal refusal =
          core.step(e, due ? &wanted : nullptr, looks ? place(row, at_.task_rotation) : nullptr, s, answer);
      if (refusal.fault != step::Fault::none) return false;
    } catch (const std::invalid_argument&) {
      return false;  // a rotation that is none
    }
    state_.stale = state_.stale || answer.solved;
    state_.source = answer.source;
    write(answer, row + begin_);
    return true;
  }

 private:
  const PyStep& step_;
  PyState& state_;
  PartPlaces at_;
  int count_, phase_;
  std::vector<int> phases_;  // number of a name -> phase of the controller
  int begin_;
  step::Ahead ahead_;
  step::Memory memory_;  // before the block, as all that follows
  step::Series series_;
  step::Kept kept_;
  step::Source source_ = step::Source::plan;

  static const double* place(const double* row, int at) { return at < 0 ? nullptr : row + at; }

  step::Estimated estimated(const double* row, bool due) const {
    const step::Settings& settings = step_.core().settings();
    const step::Compensations& c = settings.compensation;
    step::Estimated e{};
    e.time = row[at_.time];
    e.contact = e.stiffness = -1;
    e.q = row + at_.q;
    e.v = row + at_.v;
    if (settings.torque_state()) e.torque = place(row, at_.torque);
    if (settings.force_state() || due) e.wrench = place(row, at_.wrench);
    if (c.disturbance) e.disturbance = place(row, at_.disturbance);
    if (!due) return e;
    if (at_.contact >= 0) e.contact = row[at_.contact] != 0;
    if (!c.environment || at_.environment < 0) return e;
    e.stiffness = row[at_.environment];
    e.damping = row[at_.environment + 1];
    e.damping_std = row[at_.environment + 3];
    return e;
  }
  void read(const double* row, step::Wanted& wanted) {
    wanted.time = row[at_.time];
    wanted.has_task = wanted.has_any = true;
    wanted.task = {row + at_.position, place(row, at_.rotation), row + at_.velocity, row + at_.pressed,
                   place(row, at_.task_rotation)};
    wanted.first = wanted.task;
    wanted.posture = place(row, at_.posture);
    wanted.phase = phase_;
    wanted.ahead = &ahead_;
    wanted.has_ahead = at_.has_ahead >= 0 && row[at_.has_ahead] != 0;
    if (!wanted.has_ahead) return;
    const auto rows = [row](int at, long stride) { return at < 0 ? Rows{} : Rows{row + at, stride}; };
    ahead_.count = count_;
    ahead_.time = rows(at_.instants, 1);
    ahead_.position = rows(at_.positions, 3);
    ahead_.rotation = rows(at_.rotations, 9);
    ahead_.velocity = rows(at_.velocities, 6);
    ahead_.wrench = rows(at_.wrenches, 6);
    ahead_.posture = rows(at_.postures, step_.core().settings().n());
    ahead_.task_rotation = rows(at_.task_rotations, 9);
    for (int k = 0; k < count_; ++k) ahead_.phase[size_t(k)] = phases_[size_t(row[at_.phases + k])];
  }
  // Torque and what the limits took away (n each), then the diagnostics in the order of `channels_of` and of
  // `MpcController`.
  void write(const step::Answer& answer, double* out) const {
    const step::State& s = state_.state;
    const step::Memory& m = s.memory;
    const int n = step_.core().settings().n();
    out = std::copy(answer.torque, answer.torque + n, out);
    out = std::copy(answer.clamped, answer.clamped + n, out);
    for (const double one : {double(m.report.iterations), m.report.kkt, m.report.cost, m.report.gap, m.report.violation,
                             double(int(m.report.status)), double(m.deadline_missed), double(m.contact_nodes)})
      *out++ = one;
    out = std::copy(s.series.path.begin(), s.series.path.end(), out);
    out = std::copy(s.series.forces.begin(), s.series.forces.end(), out);
    *out++ = double(int(answer.source));
    *out++ = double(m.failures);
    out = std::copy(m.disturbance, m.disturbance + n, out);
    *out = m.force_shift;
  }
};

// places: by the names of `PartPlaces`; what is missing is nowhere.
inline void build_part(StepPart* self, const PyStep& step, PyState& state, const std::map<std::string, int>& places,
                       int count, nb::str phase, const std::vector<nb::object>& names, int begin) {
  const auto at = [&places](const char* name) {
    const auto found = places.find(name);
    return found == places.end() ? -1 : found->second;
  };
  if (!step.core().fits(state.state)) throw std::invalid_argument("this state belongs to another controller");
  for (const char* name : {"time", "q", "v", "position", "velocity", "pressed"})
    if (at(name) < 0) throw std::invalid_argument(std::string("a controller needs a place for ") + name);
  for (const char* name : {"instants", "positions", "velocities", "wrenches", "phases"})
    if (at("has_ahead") >= 0 && at(name) < 0)
      throw std::invalid_argument(std::string("a preview needs a place for ") + name);
  std::vector<int> phases;
  for (const nb::object& name : names) phases.push_back(step.phase_of(name));
  new (self) StepPart(step, state, {at("time"),           at("q"),           at("v"),
                                    at("torque"),         at("wrench"),      at("disturbance"),
                                    at("contact"),        at("environment"), at("position"),
                                    at("rotation"),       at("velocity"),    at("pressed"),
                                    at("task_rotation"),  at("posture"),     at("has_ahead"),
                                    at("instants"),       at("positions"),   at("rotations"),
                                    at("velocities"),     at("wrenches"),    at("postures"),
                                    at("task_rotations"), at("phases")},
                      count, step.phase_of(phase), std::move(phases), begin);
}

inline void bind_part(nb::module_& m) {
  nb::module_::import_("pliant._loop");
  nb::class_<StepPart, Part>(m, "StepPart")
      .def("__init__", &build_part, nb::keep_alive<1, 2>(), nb::keep_alive<1, 3>(), "step"_a, "state"_a, "places"_a,
           "count"_a, "phase"_a, "names"_a, "begin"_a);
}

}  // namespace pliant::mpc::binding
