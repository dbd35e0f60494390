// Python face of the imperfect robot.
#pragma once
#include "bind_physics.hpp"
#include "imperfect_robot.hpp"

namespace pliant::plant {

class PyImperfectRobot {
 public:
  explicit PyImperfectRobot(Settings settings) : robot_(std::move(settings)) {}

  int memory_size() const { return robot_.memory_size(); }
  int draws() const { return robot_.draws(); }
  int reading_size() const { return 4 * settings().n + 6 * settings().frames; }

  void init(const Vector& memory, const ConstVector& held, const ConstVector& gain, const ConstVector& bias,
            const ConstVector& sensor_gain, const ConstVector& sensor_offset, const ConstVector& now,
            const ConstVector& draw, const Vector& out) const {
    check(memory, draw, out);
    for (const auto* values : {&held, &gain, &bias, &sensor_gain, &sensor_offset})
      expect(values->size(), settings().n, "a value per joint");
    const Drawn drawn{gain.data(), bias.data(), sensor_gain.data(), sensor_offset.data()};
    robot_.init(memory.data(), held.data(), drawn, truth(now), draw.data(), reading(out.data()));
    std::copy(held.data(), held.data() + settings().n, sent(out.data()));
  }

  // The steps of a period round a robot that is not compiled.
  void drive(const Vector& memory, const ConstVector& command, const Vector& asked) const {
    expect(memory.size(), memory_size(), "memory");
    expect(command.size(), settings().n, "command");
    expect(asked.size(), settings().n, "asked");
    robot_.ask(memory.data(), command.data(), asked.data());
    robot_.drive(memory.data(), asked.data());
  }
  void gear(const Vector& memory, const ConstVector& draw, int index, const Vector& torque) const {
    expect(memory.size(), memory_size(), "memory");
    expect(draw.size(), draws(), "draw");
    expect(torque.size(), settings().n, "torque");
    if (index < 0 || index >= settings().inner) throw std::invalid_argument("there is no such step");
    robot_.gear(memory.data(), draw.data(), index, torque.data());
  }
  void moved(const Vector& memory, const ConstVector& v) const {
    expect(memory.size(), memory_size(), "memory");
    expect(v.size(), settings().n, "v");
    robot_.moved(memory.data(), v.data());
  }
  void sense(const Vector& memory, const ConstVector& draw, const ConstVector& now, const Vector& out) const {
    check(memory, draw, out);
    robot_.sense(memory.data(), draw.data(), truth(now), reading(out.data()));
  }

  // A whole period round a compiled robot. draws: (ticks, draws); out: reading, then the robot's own outcome. As
  // `Physics.step` it gives the frames that touch, or -1.
  int64_t period(const Vector& memory, const ConstVector& draws, const PyPhysics& robot, nb::handle data,
                 const ConstVector& command, const std::vector<PushRow>& more, const Vector& out) const {
    const Settings& s = settings();
    expect(memory.size(), memory_size(), "memory");
    expect(draws.size(), s.ticks * this->draws(), "draws");
    expect(command.size(), s.n, "command");
    expect(out.size(), reading_size() + robot.physics().outcome_size(), "out");
    if (robot.physics().world().n != s.n || int(robot.physics().world().sensors.size()) != s.frames)
      throw std::invalid_argument("the imperfections are those of another robot");
    const std::vector<Push> pushes = robot.all_pushes(more);
    auto* d = pointed<mjData>(data);
    double *row = memory.data(), *to = out.data();
    const double *draw = draws.data(), *asked = command.data();
    nb::gil_scoped_release release;
    return run(row, draw, robot.physics(), d, asked, pushes, to);
  }

  // The same without Python.
  int64_t run(double* memory, const double* draw, const Physics& physics, mjData* data, const double* command,
              const std::vector<Push>& pushes, double* out) const {
    const Settings& s = settings();
    const Outcome outcome = physics.outcome(out + reading_size());
    const True now{outcome.q, outcome.v, outcome.torque, outcome.readings};
    double* total = sent(out);
    std::fill(total, total + s.n, 0.0);
    Doubles asked(size_t(s.n)), torque(size_t(s.n));
    std::uint64_t touching = 0;
    for (int tick = 0; tick < s.ticks; ++tick, draw += draws()) {
      robot_.ask(memory, command, asked.data());
      for (int i = 0; i < s.n; ++i) total[i] += asked[size_t(i)] / s.ticks;
      robot_.drive(memory, asked.data());
      for (int k = 0; k < s.inner; ++k) {
        robot_.gear(memory, draw, k, torque.data());
        if (!physics.step(data, torque.data(), pushes, outcome, touching)) return -1;
        robot_.moved(memory, outcome.v);
      }
      robot_.sense(memory, draw, now, reading(out));
    }
    return static_cast<int64_t>(touching);
  }
  const Settings& settings() const { return robot_.settings(); }

 private:
  Reading reading(double* out) const {
    const int n = settings().n;
    return {out, out + n, out + 2 * n, out + 4 * n};
  }
  double* sent(double* out) const { return out + 3 * settings().n; }
  True truth(const ConstVector& now) const {
    const int n = settings().n;
    expect(now.size(), 3 * n + 6 * settings().frames, "what is true");
    return {now.data(), now.data() + n, now.data() + 2 * n, now.data() + 3 * n};
  }
  void check(const Vector& memory, const ConstVector& draw, const Vector& out) const {
    expect(memory.size(), memory_size(), "memory");
    expect(draw.size(), draws(), "draw");
    expect(out.size(), reading_size(), "out");
  }

  ImperfectRobot robot_;
};

inline void init_imperfect_robot(PyImperfectRobot* self, int n, int frames, int ticks, int inner, int under_way,
                                 Doubles limit, Doubles dry, Doubles viscous, Doubles noise, double friction_velocity,
                                 double kept, Doubles loop, Doubles ripple, std::vector<int> late, Doubles noise_q,
                                 Doubles noise_v, Doubles noise_torque, Doubles noise_wrench) {
  if (n < 1 || frames < 0 || ticks < 1 || inner < 1 || under_way < 0)
    throw std::invalid_argument("sizes of imperfections must not be negative");
  for (const auto* values : {&limit, &dry, &viscous, &noise, &noise_q, &noise_v, &noise_torque})
    expect(values->size(), n, "a value per joint");
  expect(loop.size(), 4, "loop");
  expect(ripple.size(), 4, "ripple");
  expect(late.size(), 3, "late");
  expect(noise_wrench.size(), 2, "noise_wrench");
  Settings s;
  s.n = n;
  s.frames = frames;
  s.ticks = ticks;
  s.inner = inner;
  s.under_way = under_way;
  s.gears = {std::move(limit), std::move(dry), std::move(viscous), std::move(noise), friction_velocity, kept};
  s.loop = {loop[0], loop[1], loop[2], loop[3]};
  s.ripple = {ripple[0], ripple[1], ripple[2], ripple[3]};
  s.sensors = {late[0],
               late[1],
               late[2],
               std::move(noise_q),
               std::move(noise_v),
               std::move(noise_torque),
               {noise_wrench[0], noise_wrench[1]}};
  new (self) PyImperfectRobot(std::move(s));
}

}  // namespace pliant::plant
