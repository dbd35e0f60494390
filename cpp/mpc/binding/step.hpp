// ControllerStep and ControllerState: a predictive controller between estimate and torque, in one call.
#pragma once
#include <nanobind/stl/optional.h>

#include <optional>

#include "../step/controller.hpp"
#include "nodes.hpp"
#include "signals.hpp"
#include "state_bytes.hpp"

namespace pliant::mpc::binding {

struct PyState {
  step::State state;
  step::Source source = step::Source::plan;
  nb::object channels;  // of the last solve; none: they have to be made
  step::Ahead ahead;    // scratch space
  bool stale = false;   // whether the channels are those of an earlier solve
};

// Diagnostics of the last solve, a new dictionary for each; names are those of pliant.mpc.diagnostics.
inline nb::object channels_of(PyState& s) {
  if (s.channels.is_valid() && !s.stale) return s.channels;
  s.stale = false;
  const step::Memory& m = s.state.memory;
  const size_t N = size_t(s.state.options.horizon);
  nb::dict found;
  found["mpc/iterations"] = double(m.report.iterations);
  found["mpc/kkt"] = m.report.kkt;
  found["mpc/cost"] = m.report.cost;
  found["mpc/gap"] = m.report.gap;
  found["mpc/violation"] = m.report.violation;
  found["mpc/status"] = double(int(m.report.status));
  found["mpc/deadline_missed"] = double(m.deadline_missed);
  found["mpc/contact_nodes"] = double(m.contact_nodes);
  found["mpc/predicted_path"] = array(s.state.series.path, {N + 1, 3});
  found["mpc/predicted_force"] = array(s.state.series.forces, {N, size_t(s.state.model.contact_dim)});
  return s.channels = found;
}

class PyStep {
 public:
  PyStep(step::Settings settings, nb::object frame, nb::object contact_frame, std::vector<nb::object> phases)
      : core_(std::move(settings)),
        frame_(std::move(frame)),
        contact_frame_(std::move(contact_frame)),
        phases_(std::move(phases)) {}

  PyState* init(double time, nb::handle q, nb::handle v, nb::handle torque_sent) const {
    const long n = core_.settings().n();
    Numbers joints[3];
    return new PyState{step::State(core_.settings(), time, joints[0].vector(q, "q", n), joints[1].vector(v, "v", n),
                                   joints[2].vector(torque_sent, "torque_sent", n)),
                       step::Source::plan,
                       {},
                       {}};
  }

  const step::Controller& core() const { return core_; }

  int phase_of(nb::handle name) const {
    for (size_t i = 0; i < phases_.size(); ++i)
      if (same_text(phases_[i], name)) return int(i);
    return nb::len(name) == 0 ? step::unnamed_phase : step::unknown_phase;
  }

  // (fault, node, value, normal) or None.
  nb::object step(nb::handle estimate, nb::handle reference, PyState& s, nb::handle out) const {
    const step::Settings& settings = core_.settings();
    const step::Compensations& c = settings.compensation;
    if (!core_.fits(s.state)) throw std::invalid_argument("this state belongs to another controller");
    const double time = read_time(estimate);
    const bool due = core_.due(time, s.state);
    const ReadEstimate e(estimate, time, contact_frame_, settings.n(),
                         {settings.force_state(), settings.torque_state(), c.disturbance, due, c.environment});
    std::optional<ReadTask> own, first;
    step::Wanted wanted{};
    ReadPreview preview;
    Numbers posture, axes;
    const double* R_world_task = nullptr;
    const bool looks = due || (settings.riccati && settings.model.axes == Axes::surface);
    if (looks) {
      read_tasks(read_attribute(reference, names().tasks), own, first);
      if (own && own->data.task_rotation) R_world_task = own->data.task_rotation;
    }
    if (due) read_wanted(reference, own, first, preview, posture, s.ahead, wanted);
    step::Answer answer;
    step::Refusal refusal;
    {
      const nb::gil_scoped_release released;
      refusal = core_.step(e.data, due ? &wanted : nullptr, R_world_task, s.state, answer);
    }
    if (refusal.fault != step::Fault::none)
      return nb::make_tuple(fault_names[int(refusal.fault)], refusal.node, refusal.value,
                            nb::make_tuple(refusal.normal[0], refusal.normal[1], refusal.normal[2]));
    if (answer.solved) s.channels = {};
    s.source = answer.source;
    write(answer, s, out);
    return nb::none();
  }

 private:
  static constexpr const char* fault_names[] = {
      "none",  "no_wrench",     "no_disturbance",      "no_task", "reference_not_finite",
      "pulls", "unknown_phase", "no_phase_for_contact"};

  void read_tasks(nb::handle tasks, std::optional<ReadTask>& own, std::optional<ReadTask>& first) const {
    for (nb::handle task : tasks) {
      if (!first) first.emplace(task);
      if (same_text(read_attribute(task, names().frame), frame_)) {
        own.emplace(task);
        return;
      }
    }
  }
  void read_wanted(nb::handle reference, const std::optional<ReadTask>& own, const std::optional<ReadTask>& first,
                   ReadPreview& preview, Numbers& posture, step::Ahead& ahead, step::Wanted& wanted) const {
    const long n = core_.settings().n();
    wanted.time = read_time(reference);
    if ((wanted.has_task = own.has_value())) wanted.task = own->data;
    if ((wanted.has_any = first.has_value())) wanted.first = first->data;
    if (const nb::object q = read_attribute(reference, names().posture); !q.is_none())
      wanted.posture = posture.vector(q, "the reference's posture", n);
    wanted.phase = phase_of(read_attribute(reference, names().phase));
    const nb::object later = read_attribute(reference, names().preview);
    if ((wanted.has_ahead = !later.is_none()))
      preview.read(later, n, [this](nb::handle name) { return phase_of(name); }, ahead);
    wanted.ahead = &ahead;
  }
  // Rows of `out` (3, n): torque, what the limits took away, disturbance.
  void write(const step::Answer& answer, const PyState& s, nb::handle out) const {
    const size_t n = size_t(core_.settings().n());
    const auto rows = nb::cast<Packed<double>>(out, false);
    if (rows.size() != 3 * n) throw std::invalid_argument("out must have 3 rows of a number per joint");
    double* row = rows.data();
    for (const double* values : {answer.torque, answer.clamped, s.state.memory.disturbance}) {
      std::memcpy(row, values, n * sizeof(double));
      row += n;
    }
  }

  step::Controller core_;
  nb::object frame_, contact_frame_;
  std::vector<nb::object> phases_;
};

}  // namespace pliant::mpc::binding
