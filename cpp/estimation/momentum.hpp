// The generalised-momentum observer (src/pliant/estimation/momentum_observer.py).
#pragma once
#include <optional>

#include "stage.hpp"
#include "surface.hpp"
#include "../shared/tree.hpp"

namespace pliant::estimation {

using namespace bodies;

struct ObserverSettings {
  double gain = 0;            // [rad/s]
  bool measured = false;      // the torque sensors' torque, else the one that was sent
  bool along_normal = false;  // of a contact wrench the force along the surface's normal, else all of it
  std::shared_ptr<const Surface> surface;
  std::optional<Names> frames;  // whose wrenches count; nothing: all
  Compensation compensation = Compensation::none;
  int late = 0;  // periods by which q and v are older than the torque that arrives with them
};

class MomentumStage final : public Stage {
 public:
  MomentumStage(std::shared_ptr<const Tree> robot, ObserverSettings settings);

  std::unique_ptr<Stage> bound(int n, Names& frames) const override;
  bool in_python() const override { return settings_.surface && settings_.surface->in_python(); }
  int size() const override { return 1 + (3 + settings_.late) * n_; }
  void init(const Reading& reading, double* memory) const override;
  void begin(const Reading& reading, const Belief& belief, double* memory) override;
  Refusal step(const Reading& reading, Belief& belief, double* memory) override;

 private:
  std::shared_ptr<const Tree> robot_;
  ObserverSettings settings_;
  int n_ = 0;
  std::vector<std::pair<int, Frame>> contacts_;  // row of the wrench, frame
  std::vector<Body> bodies_;                     // scratch space, as all that follows
  std::vector<Screw> screws_;
  std::vector<double> momentum_, explained_, applied_;

  // A memory: time, p (n), Jᵀλ + β (n), disturbance (n), torques under way (late, n), the oldest first.
  double* momentum(double* memory) const { return memory + 1; }
  double* explained(double* memory) const { return memory + 1 + n_; }
  double* disturbance(double* memory) const { return memory + 1 + 2 * n_; }
  double* torques(double* memory) const { return memory + 1 + 3 * n_; }
  const double* applied(const Reading& reading) const {
    return settings_.measured ? reading.torque : reading.torque_sent;
  }
  void model_terms(const Reading& reading, const Belief& belief, double* p, double* explained);
};

}  // namespace pliant::estimation
