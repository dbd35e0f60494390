// The first stage of a chain: joint signals as they are, contact wrenches from force/torque sensors, and what touches.
#pragma once
#include <map>
#include <memory>

#include "stage.hpp"
#include "tare.hpp"
#include "../shared/tree.hpp"

namespace pliant::estimation {

using namespace bodies;

struct WrenchSettings {
  double velocity_gain = 1;
  double begin = 0, end = 0, linger = 0;  // thresholds of touch [N], [N], [s]
  std::map<std::string, Load> carried;
  std::map<std::string, std::string> contact_frames;  // sensor → the frame beyond it that touches
  double acceleration_cutoff = 0;                     // [Hz]
  TareSettings tare;
};

class WrenchStage final : public Stage {
 public:
  // Without a robot it looks at no wrench.
  WrenchStage(std::shared_ptr<const Tree> robot, WrenchSettings settings);

  std::unique_ptr<Stage> bound(int n, Names& frames) const override;
  int size() const override;
  void init(const Reading& reading, double* memory) const override;
  Refusal step(const Reading& reading, Belief& belief, double* memory) override;

 private:
  std::shared_ptr<const Tree> robot_;
  WrenchSettings settings_;
  int n_ = 0;
  struct Sensor {
    Frame frame, touching;
    bool beyond;  // whether it touches elsewhere than at its own frame
    bool loaded;
    Load load;
  };
  std::vector<Sensor> sensors_;
  std::vector<Body> bodies_;  // scratch space
  std::vector<double> acceleration_;

  int count() const { return int(sensors_.size()); }
  bool accelerates() const { return !settings_.carried.empty() || settings_.tare.wanted; }
  double* above(double* memory) const { return memory + n_; }
  double* motion(double* memory) const { return above(memory) + count(); }  // time, first (n), second (n)
  TareMemory tare(double* memory) const { return TareMemory(motion(memory) + 1 + 2 * n_); }

  void move(const Reading& reading, double* memory);
  void unexplained(int sensor, const Body& at, const TareMemory* tare, const double* reading, Vec3& force,
                   Vec3& moment) const;
  Refusal take_in(const Reading& reading, const TareMemory& tare) const;
};

}  // namespace pliant::estimation
