// A low-pass filter of up to second order, in transposed direct form II:
// y = b_0 x + s_1, s_1 <- b_1 x - a_1 y + s_2, s_2 <- b_2 x - a_2 y.
#pragma once

namespace pliant::estimation {

struct LowPass {
  double b_0, b_1, b_2, a_1, a_2;

  // The memory of a filter that has seen x (k) for ever.
  void init(const double* x, int k, double* s_1, double* s_2) const {
    for (int i = 0; i < k; ++i) {
      s_1[i] = (1 - b_0) * x[i];
      s_2[i] = (b_2 - a_2) * x[i];
    }
  }
  // Filters in place.
  void step(double* x, int k, double* s_1, double* s_2) const {
    for (int i = 0; i < k; ++i) {
      const double y = b_0 * x[i] + s_1[i];
      s_1[i] = b_1 * x[i] - a_1 * y + s_2[i];
      s_2[i] = b_2 * x[i] - a_2 * y;
      x[i] = y;
    }
  }
};

}  // namespace pliant::estimation
