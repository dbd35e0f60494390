// Rows of a function of time, worked out once for each tick of a clock, many ticks in one go.
#pragma once
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "../shared/numpy_new.hpp"

namespace pliant::references {

namespace nb = nanobind;

// A cache: what it gives depends on the time asked for, not on what was asked before.
class RowsAhead {
 public:
  static constexpr long kChunk = 128;  // rows
  static constexpr long kFar = 512;    // rows ahead; instants farther apart are worked out one by one

  // Args: times (m,) s, zero or more, to rows (m, width), each of its own time only; s by which two ticks may differ.
  RowsAhead(nb::object rows, double rounding) : rows_(std::move(rows)), rounding_(rounding) {}

  size_t width() const { return width_; }

  // The row at a time in s, now; valid until the next call. Args: s; s from one tick of the clock to the next, 0: it is
  // not regular.
  const double* now(double time, double period) {
    long index = 0;
    const bool found = index_of(time, index);
    if (!found || index < now_ || index > now_ + kFar) {
      if (period <= 0.0) return alone({time});
      start(time, period);
      index = 0;
    }
    begun_ = true;
    reach(index);
    now_ = index;
    return row(index);
  }

  // Rows at equally spaced times from now on, each the first `columns` numbers. Args: times (m,), m ≥ 1, less `start`;
  // s from one tick of the clock to the next, 0: it is not regular.
  void ahead(const double* times, size_t count, double start, double period, double* out, size_t columns) {
    if (!begun_ && period > 0.0) await(times[0] - start, period);
    const long gaps = std::max<long>(long(count) - 1, 1);
    long first = 0, last = 0;
    const bool found = index_of(times[0] - start, first) && index_of(times[count - 1] - start, last);
    if (!found || first < now_ || last < first || last > now_ + kFar || (last - first) % gaps != 0) {
      std::vector<double> local(times, times + count);
      for (double& time : local) time -= start;
      const double* rows = alone(std::move(local));
      check(columns);
      for (size_t i = 0; i < count; ++i) std::copy_n(rows + i * width_, columns, out + i * columns);
      return;
    }
    reach(last);
    check(columns);
    const long step = std::max<long>((last - first) / gaps, 1);
    for (size_t i = 0; i < count; ++i) std::copy_n(row(first + long(i) * step), columns, out + i * columns);
  }

 private:
  nb::object rows_;
  double rounding_, origin_ = 0.0, period_ = 0.0;
  long first_ = 0, now_ = 0;
  bool begun_ = false;  // there was a row now; before, the first tick is expected
  size_t width_ = 0;
  std::vector<double> table_;
  nb::object beside_;  // rows that are no ticks

  long count() const { return width_ ? long(table_.size() / width_) : 0; }
  const double* row(long index) const { return table_.data() + size_t(index - first_) * width_; }
  void check(size_t columns) const {
    if (columns > width_) throw std::invalid_argument("a row has fewer numbers than were asked for");
  }

  void start(double origin, double period) {
    origin_ = origin;
    period_ = period;
    first_ = now_ = 0;
    table_.clear();
  }

  // Before the first row is asked for: its time is the first tick from zero on of the clock that has one at `time`.
  void await(double time, double period) {
    long index = 0;
    if (time < 0.0 || (index_of(time, index) && std::abs(period - period_) < rounding_)) return;
    start(time - period * std::floor((time + rounding_) / period), period);
  }

  // Number of the tick at a time in s, from the first on. False: there is none.
  bool index_of(double time, long& index) const {
    if (period_ == 0.0) return false;
    const double steps = (time - origin_) / period_;
    if (!(std::abs(steps) < 1e15)) return false;
    const double whole = std::nearbyint(steps);
    index = long(whole);
    return std::abs(steps - whole) * period_ < rounding_;
  }

  void reach(long last) {
    const long have = first_ + count();
    if (last < have) return;
    std::vector<double> times(size_t(std::max(last + 1, have + kChunk) - have));
    for (size_t i = 0; i < times.size(); ++i) times[i] = origin_ + period_ * double(have + long(i));
    const size_t more = times.size();
    const nb::object rows = worked_out(std::move(times));
    const size_t past = std::min(size_t(now_ - first_), size_t(count()));
    table_.erase(table_.begin(), table_.begin() + long(past * width_));
    table_.insert(table_.end(), data_of(rows), data_of(rows) + more * width_);
    first_ = have + long(more) - count();
  }

  const double* alone(std::vector<double> times) {
    beside_ = worked_out(std::move(times));
    return data_of(beside_);
  }

  // Times without the rounding of a clock, so that an instant is the same in two ticks, to rows side by side.
  nb::object worked_out(std::vector<double> times) {
    const nb::object clean = new_array({npy_intp(times.size())});
    for (size_t i = 0; i < times.size(); ++i)
      data_of(clean)[i] = std::nearbyint(1e9 * std::max(times[i], 0.0)) / 1e9;  // ns
    nb::object rows = rows_(clean);
    const PyArrayObject* array = doubles_of(rows);
    if (!array || PyArray_NDIM(array) != 2 || !PyArray_IS_C_CONTIGUOUS(array) ||
        size_t(PyArray_DIMS(array)[0]) != times.size() || (width_ && size_t(PyArray_DIMS(array)[1]) != width_))
      throw std::invalid_argument("there must be a row of float64 for each time, all of one width");
    width_ = size_t(PyArray_DIMS(array)[1]);
    return rows;
  }
};

}  // namespace pliant::references
