// Python face of the robot and of the stages of a chain. Values are checked in Python; shapes are checked here.
#pragma once
#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "../shared/python_signals.hpp"
#include "environment.hpp"
#include "filtered.hpp"
#include "joint_state.hpp"
#include "momentum.hpp"
#include "wrench.hpp"

namespace pliant::estimation {

using Doubles = std::vector<double>;
using PoseRow = std::tuple<Doubles, Doubles>;                                                // R (9), p (3)
using JointRow = std::tuple<int, PoseRow, Doubles, bool, double, Doubles, Doubles, double>;  // see Joint
using FrameRow = std::tuple<std::string, int, PoseRow>;
using LoadRow = std::tuple<double, Doubles, Doubles, Doubles>;  // mass, centre (3), bias (6), inertia (9)
using FilterRow = std::tuple<double, double, double, double, double>;

inline const double* of_size(const Doubles& values, size_t size, const char* name) {
  if (values.size() != size)
    throw std::invalid_argument(std::string(name) + " must have " + std::to_string(size) + " entries, got " +
                                std::to_string(values.size()));
  return values.data();
}
inline Vec3 vector_of(const Doubles& values, const char* name) { return load(of_size(values, 3, name)); }
inline Pose pose_of(const PoseRow& row) {
  Pose made{};
  const double* R = of_size(std::get<0>(row), 9, "a rotation");
  std::copy(R, R + 9, made.R);
  made.p = vector_of(std::get<1>(row), "a position");
  return made;
}
inline LowPass filter_of(const FilterRow& row) {
  return std::apply([](auto... b) { return LowPass{b...}; }, row);
}
inline FilteredStage::Filter filter_of(const std::optional<FilterRow>& row) {
  return row ? FilteredStage::Filter(filter_of(*row)) : std::nullopt;
}
inline Load load_of(const LoadRow& row) {
  const auto& [mass, center, bias, inertia] = row;
  Load made;
  made.mass = mass;
  made.center = vector_of(center, "a centre");
  made.force = load(of_size(bias, 6, "a bias"));
  made.moment = load(bias.data() + 3);
  const double* I = of_size(inertia, 9, "an inertia");
  std::copy(I, I + 9, made.inertia);
  return made;
}

// A surface that only Python knows.
class PythonSurface final : public Surface {
 public:
  explicit PythonSurface(nb::object near) : near_(std::move(near)) {}
  bool in_python() const override { return true; }
  double near(const Vec3& place, Vec3& normal) const override {
    const nb::object found = near_(nb::make_tuple(place.x, place.y, place.z));
    Numbers numbers;
    normal = load(numbers.vector(found[1], "a surface's normal", 3));
    return nb::cast<double>(found[0]);
  }

 private:
  nb::object near_;
};

inline void init_tree(Tree* self, const std::vector<JointRow>& rows, const std::vector<FrameRow>& named,
                      const Doubles& gravity) {
  std::vector<Joint> joints;
  for (const auto& [parent, placement, axis, prismatic, mass, center, inertia, rotor] : rows) {
    Joint made{
        parent, pose_of(placement), vector_of(axis, "an axis"), prismatic, mass, vector_of(center, "a centre"), {},
        rotor};
    const double* I = of_size(inertia, 9, "an inertia");
    std::copy(I, I + 9, made.inertia);
    joints.push_back(made);
  }
  std::vector<Frame> frames;
  for (const auto& [name, joint, placement] : named) frames.push_back({name, joint, pose_of(placement)});
  new (self) Tree(std::move(joints), std::move(frames), vector_of(gravity, "gravity"));
}

inline void init_wrench(WrenchStage* self, std::shared_ptr<Tree> robot, double velocity_gain, double begin, double end,
                        double linger, const std::map<std::string, LoadRow>& carried,
                        std::map<std::string, std::string> contact_frames, double acceleration_cutoff,
                        const std::optional<std::tuple<double, bool, double>>& tare) {
  WrenchSettings s;
  s.velocity_gain = velocity_gain;
  s.begin = begin;
  s.end = end;
  s.linger = linger;
  for (const auto& [sensor, row] : carried) s.carried.emplace(sensor, load_of(row));
  s.contact_frames = std::move(contact_frames);
  s.acceleration_cutoff = acceleration_cutoff;
  if (tare) s.tare = {true, std::get<0>(*tare), std::get<1>(*tare), std::get<2>(*tare)};
  new (self) WrenchStage(std::move(robot), std::move(s));
}

inline void init_momentum(MomentumStage* self, std::shared_ptr<Tree> robot, double gain, bool measured,
                          std::shared_ptr<Surface> surface, bool along_normal, std::optional<Names> frames,
                          bool gravity, bool coriolis, int late) {
  if (late < 0) throw std::invalid_argument("late must not be negative");
  const Compensation compensation = coriolis  ? Compensation::gravity_and_coriolis
                                    : gravity ? Compensation::gravity
                                              : Compensation::none;
  new (self) MomentumStage(std::move(robot),
                           {gain, measured, along_normal, std::move(surface), std::move(frames), compensation, late});
}

inline FitSettings fit_of(const FilterRow& filter, double touch, double least_force, double least_motion,
                          const std::tuple<double, double>& noise, double correlated, double samples,
                          double least_samples, double accuracy, double drift) {
  return {filter_of(filter), touch,   least_force,   least_motion, {std::get<0>(noise), std::get<1>(noise)},
          correlated,        samples, least_samples, accuracy,     drift};
}

using Row = Packed<double, 1>;

inline void fit_step(const EnvironmentFit& fit, double force, double depth, double rate, const Row& memory) {
  if (memory.size() != size_t(fit_size)) throw std::invalid_argument("memory must have FIT_SIZE entries");
  FitMemory found;
  std::memcpy(&found, memory.data(), sizeof found);
  fit.step(force, depth, rate, found);
  std::memcpy(memory.data(), &found, sizeof found);
}

inline void filter_step(const FilterRow& filter, const Row& values, const Row& first, const Row& second) {
  if (first.size() != values.size() || second.size() != values.size())
    throw std::invalid_argument("a filter's memory must have an entry for each value");
  filter_of(filter).step(values.data(), int(values.size()), first.data(), second.data());
}

inline void bind_stages(nb::module_& m) {
  m.attr("FIT_SIZE") = fit_size;
  m.attr("FIT_FOUND") = int(offsetof(FitMemory, known) / sizeof(double));
  m.attr("FIT_COVARIANCE") = int(offsetof(FitMemory, covariance) / sizeof(double));
  m.def("filter_step", &filter_step, "filter"_a, "values"_a.noconvert(), "first"_a.noconvert(), "second"_a.noconvert());
  nb::class_<Tree>(m, "Tree").def("__init__", &init_tree, "joints"_a, "frames"_a, "gravity"_a);
  nb::class_<Surface>(m, "Surface");
  nb::class_<Plane, Surface>(m, "Plane")
      .def(
          "__init__",
          [](Plane* self, const Doubles& origin, const Doubles& normal) {
            new (self) Plane(vector_of(origin, "an origin"), vector_of(normal, "a normal"));
          },
          "origin"_a, "normal"_a);
  nb::class_<PythonSurface, Surface>(m, "PythonSurface").def(nb::init<nb::object>(), "near"_a);
  nb::class_<EnvironmentFit>(m, "EnvironmentFit")
      .def(
          "__init__",
          [](EnvironmentFit* self, const FilterRow& filter, double touch, double least_force, double least_motion,
             const std::tuple<double, double>& noise, double correlated, double samples, double least_samples,
             double accuracy, double drift) {
            new (self) EnvironmentFit(fit_of(filter, touch, least_force, least_motion, noise, correlated, samples,
                                             least_samples, accuracy, drift));
          },
          nb::kw_only(), "filter"_a, "touch"_a, "least_force"_a, "least_motion"_a, "noise"_a, "correlated"_a,
          "samples"_a, "least_samples"_a, "accuracy"_a, "drift"_a = 0.0)
      .def("step", &fit_step, "force"_a, "depth"_a, "rate"_a, "memory"_a.noconvert());
  nb::class_<Stage>(m, "Stage").def_prop_ro("in_python", &Stage::in_python);
  nb::class_<WrenchStage, Stage>(m, "WrenchStage")
      .def("__init__", &init_wrench, nb::kw_only(), "robot"_a.none(), "velocity_gain"_a, "begin"_a, "end"_a, "linger"_a,
           "carried"_a, "contact_frames"_a, "acceleration_cutoff"_a, "tare"_a.none());
  nb::class_<JointStateStage, Stage>(m, "JointStateStage").def(nb::init<double>(), "memory"_a);
  nb::class_<FilteredStage, Stage>(m, "FilteredStage")
      .def(
          "__init__",
          [](FilteredStage* self, const std::optional<FilterRow>& velocity, const std::optional<FilterRow>& torque,
             const std::optional<FilterRow>& wrench) {
            new (self) FilteredStage(filter_of(velocity), filter_of(torque), filter_of(wrench));
          },
          nb::kw_only(), "velocity"_a.none(), "torque"_a.none(), "wrench"_a.none());
  nb::class_<EnvironmentStage, Stage>(m, "EnvironmentStage")
      .def(
          "__init__",
          [](EnvironmentStage* self, std::shared_ptr<Tree> robot, std::string frame, std::shared_ptr<Surface> surface,
             const EnvironmentFit& fit, double sliding, double reach, double kept) {
            new (self)
                EnvironmentStage(std::move(robot), std::move(frame), std::move(surface), fit, sliding, reach, kept);
          },
          "robot"_a, "frame"_a, "surface"_a, "fit"_a, "sliding"_a, "reach"_a, "kept"_a);
  nb::class_<MomentumStage, Stage>(m, "MomentumStage")
      .def("__init__", &init_momentum, nb::kw_only(), "robot"_a, "gain"_a, "measured"_a, "surface"_a, "along_normal"_a,
           "frames"_a.none(), "gravity"_a, "coriolis"_a, "late"_a);
}

}  // namespace pliant::estimation
