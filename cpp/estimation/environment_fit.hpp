// F = K p + B ṗ + c along a contact's normal, by least squares with exponential forgetting; the method stands in
// src/pliant/estimation/environment_fit.py.
#pragma once
#include "low_pass.hpp"
#include "stage.hpp"

namespace pliant::estimation {

struct FitSettings {
  LowPass filter;
  double touch;                      // [N]
  double least_force, least_motion;  // [N], [m]
  double noise[2];                   // variances of depth and rate after the filter
  double correlated;                 // neighbouring samples that share their noise after the filter
  double samples;                    // after which an old one counts 1/e
  double least_samples;
  double accuracy;
  double drift = 0;  // share of a new sample in the slow mean that is taken off; 0: none
};

// What a fit remembers. The signals are depth, its rate, and force [m, m/s, N].
struct FitMemory {
  double touching;      // 1: `reference` and the filter hold
  double reference[3];  // signals at first touch
  double first[3], second[3];
  double slow[3];           // mean that is taken off, after the filter
  double used;              // 1: `accepted` holds
  double accepted[3];       // filtered signals that were used last
  double count;             // samples used since first touch
  double mean[3];           // exponentially weighted
  double covariance[3][3];  //
  double known;             // 1: `found` holds; it survives the contact
  Environment found;
};
constexpr int fit_size = int(sizeof(FitMemory) / sizeof(double));

class EnvironmentFit {
 public:
  explicit EnvironmentFit(const FitSettings& settings) : settings_(settings) {}

  void step(double force, double depth, double rate, FitMemory& memory) const;

 private:
  FitSettings settings_;

  bool informative(const double* value, const FitMemory& memory) const;
  void learn(const double* value, FitMemory& memory) const;
  bool solve(const FitMemory& memory, double share, Environment& found) const;
};

}  // namespace pliant::estimation
