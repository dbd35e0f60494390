// A cubic spline through samples, with its derivatives.
#pragma once
#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <utility>
#include <vector>

namespace pliant::references {

class Spline {
 public:
  // Args: times of the samples (m), increasing; step between them, 0: they are not equally spaced; coefficients (m - 1,
  // 4, width) of every piece, which outlive this; what holds before the first and after the last sample (width).
  Spline(std::vector<double> times, double step, const double* pieces, std::vector<double> first,
         std::vector<double> last)
      : times_(std::move(times)), step_(step), pieces_(pieces), first_(std::move(first)), last_(std::move(last)) {
    if (times_.size() < 2 || first_.size() != last_.size())
      throw std::invalid_argument("a spline has two samples or more, and ends of one width");
  }

  size_t width() const { return first_.size(); }
  size_t pieces() const { return times_.size() - 1; }

  // c_0 + t c_1 + t² c_2 + t³ c_3 of the piece at a time, in this order.
  void at(double time, double* out) const {
    if (time > times_.back()) return void(std::copy(last_.begin(), last_.end(), out));
    if (time < times_.front()) return void(std::copy(first_.begin(), first_.end(), out));
    const size_t piece = piece_at(time), k = width();
    const double t = time - times_[piece], t2 = t * t, t3 = t2 * t;
    const double *c_0 = pieces_ + 4 * k * piece, *c_1 = c_0 + k, *c_2 = c_1 + k, *c_3 = c_2 + k;
    for (size_t i = 0; i < k; ++i) out[i] = c_0[i] + t * c_1[i] + t2 * c_2[i] + t3 * c_3[i];
  }

 private:
  std::vector<double> times_;
  double step_;
  const double* pieces_;
  std::vector<double> first_, last_;

  size_t piece_at(double time) const {
    const size_t most = pieces() - 1;
    if (step_ > 0.0) return std::min(size_t((time - times_.front()) / step_), most);
    const auto after = std::upper_bound(times_.begin(), times_.end(), time);
    return std::min(size_t(after - times_.begin()) - 1, most);
  }
};

}  // namespace pliant::references
