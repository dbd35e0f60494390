// Python face of the impedance core.
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <string>

#include "../shared/contract.hpp"
#include "bind_part.hpp"
#include "bind_robot.hpp"
#include "drive.hpp"

using namespace pliant::impedance;

namespace {

int step(Stack& stack, Vector memory, Vector out, ConstVector q, ConstMatrix J, nb::tuple actual, nb::tuple desired,
         nb::object bias, nb::object retune, nb::object axes) {
  const int n = stack.joints();
  expect(memory.shape(0), stack.state_size(), "memory");
  expect(out.shape(0), stack.output_size(), "out");
  expect(q.shape(0), n, "q");
  if (J.shape(0) != 6 || J.shape(1) != static_cast<std::size_t>(n) || J.stride(0) != 1 || J.stride(1) != 6) {
    reject("J must be a column-major (6, n) array");
  }
  if (!finite(q.data(), n)) return 1;
  if (const int code = read_tasks(stack, actual, desired)) return code;
  ConstVector bias_array;
  const double* added = read_bias(bias, n, bias_array);
  read_changes(stack, retune);
  std::vector<double> kept;
  if (!axes.is_none()) read_axes(stack, nb::cast<nb::tuple>(axes), kept);
  stack.step(memory.data(), out.data(), q.data(), J.data(), added, stack.input());
  return 0;
}

Law law_named(const std::string& name) {
  if (name == "capped") return Law::Capped;
  if (name == "hapfic") return Law::HapFic;
  if (name == "stack-printed") return Law::StackPrinted;
  if (name == "stack-corrected") return Law::StackCorrected;
  if (name == "spring") return Law::Spring;
  reject("unknown law " + name);
}

Shape shape_named(const std::string& name) {
  if (name == "exponential") return Shape::Exponential;
  if (name == "tanh") return Shape::Tanh;
  if (name == "exponential-printed") return Shape::ExponentialPrinted;
  if (name == "tanh-printed") return Shape::TanhPrinted;
  reject("unknown profile " + name);
}

AxisConfig axis_config(const std::string& law, double period, double rate_gain, double noise_gain, double hold_limit,
                       double blend_step, nb::object account) {
  const double noise_to_rate = rate_gain / period * std::sqrt(2.0 / (2.0 - rate_gain));
  AxisConfig config{{law_named(law), period, rate_gain, noise_gain, noise_to_rate, hold_limit, blend_step}, {}};
  config.account.active = !account.is_none();
  config.account.period = period;
  if (!config.account.active) return config;
  const auto values = nb::cast<ConstVector>(account);
  expect(values.shape(0), kAccountNumbers, "account");
  const double* v = values.data();
  config.account = {true,         period,       v[0],  v[1],  v[2],  v[3],  v[4], v[5],
                    {v[6], v[7]}, {v[8], v[9]}, v[10], v[11], v[12], v[13], v[14]};
  return config;
}

// tasks: one (axes, profile name, m/s floor, rad/s floor, moves) each.
void build(Stack* self, const std::string& law, double period, double rate_gain, double noise_gain, double hold_limit,
           double blend_step, nb::object account, ConstVector torque_limit, nb::list tasks) {
  const AxisConfig config = axis_config(law, period, rate_gain, noise_gain, hold_limit, blend_step, account);
  std::vector<TaskConfig> list;
  for (nb::handle item : tasks) {
    const auto t = nb::cast<nb::tuple>(item);
    TaskConfig task;
    task.axes = nb::cast<int>(t[0]);
    if (task.axes != 3 && task.axes != 6) reject("a task has 3 or 6 axes");
    task.shape = shape_named(nb::cast<std::string>(t[1]));
    task.rate_floor[0] = nb::cast<double>(t[2]);
    task.rate_floor[1] = nb::cast<double>(t[3]);
    for (nb::handle moves : nb::cast<nb::list>(t[4])) task.moves.push_back(nb::cast<bool>(moves) ? 1 : 0);
    expect(task.moves.size(), static_cast<int>(torque_limit.shape(0)), "moves");
    list.push_back(std::move(task));
  }
  const double* limit = torque_limit.data();
  new (self) Stack(config, std::vector<double>(limit, limit + torque_limit.shape(0)), list);
}

// errors, forces, balances (steps, trials).
void drive_axis(const std::string& law, double period, double rate_gain, double noise_gain, double hold_limit,
                double blend_step, nb::object account, const std::string& shape, ConstVector tuning, double rate_floor,
                bool rotates, ConstTable errors, Table forces, Table balances) {
  const AxisConfig config = axis_config(law, period, rate_gain, noise_gain, hold_limit, blend_step, account);
  expect(tuning.shape(0), 4, "a tuning");
  if (forces.shape(0) != errors.shape(0) || forces.shape(1) != errors.shape(1) ||
      balances.shape(0) != errors.shape(0) || balances.shape(1) != errors.shape(1)) {
    reject("errors, forces and balances must have one shape");
  }
  const double* t = tuning.data();
  const Shape form = shape_named(shape);
  const Axis axis = make_axis(form, t[0], t[1], t[2], t[3]);
  const auto steps = static_cast<int>(errors.shape(0)), trials = static_cast<int>(errors.shape(1));
  for (int i = 0; i < trials; ++i) {
    drive(config, form, axis, rate_floor, rotates, errors.data() + i, forces.data() + i, balances.data() + i, steps,
          trials);
  }
}

template <std::size_t N>
nb::tuple names(const char* const (&list)[N]) {
  nb::list made;
  for (const char* name : list) made.append(nb::str(name));
  return nb::tuple(made);
}

}  // namespace

NB_MODULE(_impedance, m) {
  pliant::agree(m, "_impedance");
  m.doc() = "Compiled core of the stack of fractal impedance tasks; `pliant.controllers.stack` is its typed face.";
  m.attr("ENERGIES") = names(Stack::kEnergyNames);
  m.attr("AXIS_ROWS") = names(Task::kRowNames);
  m.attr("TASK_SUMS") = names(Task::kSumNames);
  m.attr("ACCOUNT") = names(kAccountNames);
  nb::class_<Stack>(m, "Stack")
      .def("__init__", &build, nb::arg("law"), nb::arg("period"), nb::arg("rate_gain"), nb::arg("noise_gain"),
           nb::arg("hold_limit"), nb::arg("blend_step"), nb::arg("account").none(), nb::arg("torque_limit"),
           nb::arg("tasks"))
      .def_prop_ro("state_size", &Stack::state_size)
      .def_prop_ro("output_size", &Stack::output_size)
      .def_prop_ro("kept_back", &Stack::kept_back)
      .def("step", &step, nb::arg("memory"), nb::arg("out"), nb::arg("q"), nb::arg("J"), nb::arg("actual"),
           nb::arg("desired"), nb::arg("bias").none(), nb::arg("retune").none(), nb::arg("axes").none() = nb::none())
      .def("step_on", &step_on, nb::arg("arm"), nb::arg("memory"), nb::arg("out"), nb::arg("estimate"),
           nb::arg("targets"), nb::arg("seen").none(), nb::arg("bias").none(), nb::arg("retune").none());
  nb::class_<Arm>(m, "Arm").def(nb::init<nb::object, std::vector<nb::str>>(), nb::arg("robot"), nb::arg("frames"));
  bind_part(m);
  m.def("drive_axis", &drive_axis, nb::arg("law"), nb::arg("period"), nb::arg("rate_gain"), nb::arg("noise_gain"),
        nb::arg("hold_limit"), nb::arg("blend_step"), nb::arg("account").none(), nb::arg("shape"), nb::arg("tuning"),
        nb::arg("rate_floor"), nb::arg("rotates"), nb::arg("errors"), nb::arg("forces"), nb::arg("balances"));
}
