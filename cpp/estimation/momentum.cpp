#include "momentum.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pliant::estimation {

MomentumStage::MomentumStage(std::shared_ptr<const Tree> robot, ObserverSettings settings)
    : robot_(std::move(robot)), settings_(std::move(settings)) {}

std::unique_ptr<Stage> MomentumStage::bound(int n, Names& frames) const {
  auto made = std::make_unique<MomentumStage>(robot_, settings_);
  made->n_ = n;
  for (size_t i = 0; i < frames.size(); ++i) {
    const std::optional<Names>& wanted = settings_.frames;
    if (!wanted || std::find(wanted->begin(), wanted->end(), frames[i]) != wanted->end())
      made->contacts_.emplace_back(int(i), robot_->frame(frames[i]));
  }
  made->bodies_.resize(size_t(n));
  made->screws_.resize(size_t(n));
  for (auto* values : {&made->momentum_, &made->explained_, &made->applied_}) values->resize(size_t(n));
  return made;
}

void MomentumStage::init(const Reading& reading, double* memory) const {
  std::fill(memory, memory + size(), 0.0);
  memory[0] = reading.time;
  for (int i = 0; i < settings_.late; ++i) std::copy(applied(reading), applied(reading) + n_, torques(memory) + i * n_);
}

void MomentumStage::begin(const Reading& reading, const Belief& belief, double* memory) {
  model_terms(reading, belief, momentum(memory), explained(memory));
}

// p and Jᵀλ + β at a measurement.
void MomentumStage::model_terms(const Reading& reading, const Belief& belief, double* p, double* explained) {
  robot_->move(reading.q, reading.v, nullptr, bodies_.data());
  robot_->momentum(reading.v, bodies_.data(), settings_.compensation, screws_.data(), p, explained);
  for (const auto& [row, frame] : contacts_) {
    const double* wrench = belief.wrenches + 6 * row;
    if (std::all_of(wrench, wrench + 6, [](double x) { return x == 0; })) continue;
    Vec3 force = load(wrench), moment = load(wrench + 3);
    if (settings_.along_normal) {
      Vec3 normal;
      settings_.surface->near(robot_->at(frame, bodies_.data()).pose.p, normal);
      force = dot(normal, force) * normal;
      moment = {};
    }
    robot_->add_torque(frame, bodies_.data(), force, moment, explained);
  }
}

Refusal MomentumStage::step(const Reading& reading, Belief& belief, double* memory) {
  double period;
  if (const Refusal late = period_since(memory[0], reading.time, period); late.fault != Fault::none) return late;
  double* found = disturbance(memory);
  if (period > 0) {  // the first measurement starts the observer and is its first step, too
    const double* now = applied(reading);
    if (settings_.late > 0) {
      double *queue = torques(memory), *end = queue + settings_.late * n_;
      std::copy(queue, queue + n_, applied_.begin());
      std::copy(queue + n_, end, queue);
      std::copy(now, now + n_, end - n_);
      now = applied_.data();
    }
    model_terms(reading, belief, momentum_.data(), explained_.data());
    const double share = -std::expm1(-settings_.gain * period);
    for (int j = 0; j < n_; ++j) {
      const size_t at = size_t(j);
      double &p = momentum(memory)[j], &told = explained(memory)[j];
      const double unexplained = (momentum_[at] - p) / period - now[j] - 0.5 * (explained_[at] + told);
      found[j] += share * (unexplained - found[j]);
      p = momentum_[at];
      told = explained_[at];
    }
    memory[0] = reading.time;
  }
  std::copy(found, found + n_, belief.disturbance);
  return {};
}

}  // namespace pliant::estimation
