// Python face of the impedance core. Arrays are checked here; the core trusts them.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>

#include <string>

#include "drive.hpp"
#include "stack.hpp"

namespace nb = nanobind;
using namespace pliant::impedance;

namespace {

using Vector = nb::ndarray<double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using ConstVector = nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Table = nb::ndarray<double, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
using ConstTable = nb::ndarray<const double, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
using ConstMatrix = nb::ndarray<const double, nb::ndim<2>, nb::device::cpu>;

[[noreturn]] void reject(const std::string& message) { throw nb::value_error(message.c_str()); }

void expect(std::size_t got, int wanted, const char* name) {
  if (got != static_cast<std::size_t>(wanted)) {
    reject(std::string(name) + " must have " + std::to_string(wanted) + " entries, got " + std::to_string(got));
  }
}

bool finite(const double* x, int size) {
  double sum = 0.0;
  for (int i = 0; i < size; ++i) sum += x[i] * 0.0;  // 0 unless an entry is infinite or not a number
  return sum == 0.0;
}

void read_pose(nb::handle position, nb::handle rotation, bool needs_rotation, Pose& pose) {
  const auto p = nb::cast<ConstVector>(position);
  expect(p.shape(0), 3, "a position");
  std::copy(p.data(), p.data() + 3, pose.position);
  pose.oriented = needs_rotation && !rotation.is_none();
  if (!pose.oriented) return;
  const auto R = nb::cast<ConstMatrix>(rotation);
  if (R.shape(0) != 3 || R.shape(1) != 3) reject("a rotation must have shape (3, 3)");
  const auto row = R.stride(0), column = R.stride(1);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) pose.rotation[3 * i + j] = R.data()[i * row + j * column];
  }
}

bool finite(const Pose& pose) { return finite(pose.position, 3) && (!pose.oriented || finite(pose.rotation, 9)); }

// 0, or which input is not finite: 1 for q, 100 + i for the frame of task i, 200 + i for its reference.
int read_tasks(Stack& stack, nb::tuple actual, nb::tuple desired) {
  expect(actual.size(), 2 * stack.tasks(), "actual");
  expect(desired.size(), 2 * stack.tasks(), "desired");
  for (int i = 0; i < stack.tasks(); ++i) {
    TaskInput& in = stack.input()[i];
    in.retune = in.axes = nullptr;
    const bool six = stack.axes(i) == 6;
    read_pose(actual[2 * i], actual[2 * i + 1], six, in.actual);
    read_pose(desired[2 * i], desired[2 * i + 1], six, in.desired);
    if (!finite(in.actual)) return 100 + i;
    if (!finite(in.desired)) return 200 + i;
  }
  return 0;
}

// Axes of each task, row-major; `kept` holds them during the step.
void read_axes(Stack& stack, nb::tuple axes, std::vector<double>& kept) {
  expect(axes.size(), stack.tasks(), "axes");
  kept.resize(9 * stack.tasks());
  for (int i = 0; i < stack.tasks(); ++i) {
    if (axes[i].is_none()) continue;
    const auto R = nb::cast<ConstMatrix>(axes[i]);
    if (R.shape(0) != 3 || R.shape(1) != 3) reject("axes must have shape (3, 3)");
    for (int j = 0; j < 9; ++j) kept[9 * i + j] = R.data()[j / 3 * R.stride(0) + j % 3 * R.stride(1)];
    if (!finite(kept.data() + 9 * i, 9)) reject("axes must be finite");
    stack.input()[i].axes = kept.data() + 9 * i;
  }
}

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
  if (!bias.is_none()) {
    bias_array = nb::cast<ConstVector>(bias);
    expect(bias_array.shape(0), n, "bias");
  }
  if (!retune.is_none()) {
    for (nb::handle item : nb::cast<nb::tuple>(retune)) {
      const auto pair = nb::cast<nb::tuple>(item);
      const int task = nb::cast<int>(pair[0]);
      if (task < 0 || task >= stack.tasks()) reject("there is no task " + std::to_string(task));
      const auto values = nb::cast<ConstVector>(pair[1]);  // the tuple keeps it alive during the step
      expect(values.shape(0), 4 * stack.axes(task), "a tuning");
      stack.input()[task].retune = values.data();
    }
  }
  std::vector<double> kept;
  if (!axes.is_none()) read_axes(stack, nb::cast<nb::tuple>(axes), kept);
  stack.step(memory.data(), out.data(), q.data(), J.data(), bias.is_none() ? nullptr : bias_array.data(),
             stack.input());
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
           nb::arg("desired"), nb::arg("bias").none(), nb::arg("retune").none(), nb::arg("axes").none() = nb::none());
  m.def("drive_axis", &drive_axis, nb::arg("law"), nb::arg("period"), nb::arg("rate_gain"), nb::arg("noise_gain"),
        nb::arg("hold_limit"), nb::arg("blend_step"), nb::arg("account").none(), nb::arg("shape"), nb::arg("tuning"),
        nb::arg("rate_floor"), nb::arg("rotates"), nb::arg("errors"), nb::arg("forces"), nb::arg("balances"));
}
