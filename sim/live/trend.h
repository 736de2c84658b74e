#pragma once

#include <cmath>
#include <cstdint>

#include "controller/number.h"

namespace gauntlet::sim {

/// Least-squares line through values over time, in constant memory:
///
///     slope = S_ty / S_tt,   standard error = sqrt((S_yy - slope S_ty) / ((n - 2) S_tt))
///
/// Values that follow each other are not independent, so an error from many of them is too small;
/// callers pass means of a second.
class Trend {
 public:
  void Add(double time, double value) noexcept {
    ++count_;
    const double weight = 1.0 / static_cast<double>(count_);
    const double time_off = time - mean_time_;
    const double value_off = value - mean_value_;
    mean_time_ += weight * time_off;
    mean_value_ += weight * value_off;
    times_ += time_off * (time - mean_time_);
    values_ += value_off * (value - mean_value_);
    products_ += time_off * (value - mean_value_);
  }
  std::int64_t count() const noexcept { return count_; }
  /// NaN with fewer than three values.
  double slope() const noexcept {
    return count_ < 3 || times_ == 0.0 ? controller::kNaN : products_ / times_;
  }
  double slope_error() const noexcept {
    const double rest = values_ - slope() * products_;
    return std::sqrt(std::fmax(0.0, rest) / (static_cast<double>(count_ - 2) * times_));
  }

 private:
  std::int64_t count_ = 0;
  double mean_time_ = 0.0;
  double mean_value_ = 0.0;
  double times_ = 0.0;
  double values_ = 0.0;
  double products_ = 0.0;
};

/// Trend through the means of each second.
class TrendOfSeconds {
 public:
  void Add(std::int64_t time_ns, double value) noexcept {
    constexpr std::int64_t kSecond_ns = 1'000'000'000;
    if (count_ == 0) begin_ns_ = time_ns;
    if (time_ns - begin_ns_ >= kSecond_ns) {
      trend_.Add(static_cast<double>(begin_ns_) / (60.0 * static_cast<double>(kSecond_ns)),
                 sum_ / static_cast<double>(count_));
      begin_ns_ = time_ns;
      sum_ = 0.0;
      count_ = 0;
    }
    sum_ += value;
    ++count_;
  }
  /// Over time in minutes.
  const Trend& trend() const noexcept { return trend_; }

 private:
  Trend trend_;
  std::int64_t begin_ns_ = 0;
  double sum_ = 0.0;
  std::int64_t count_ = 0;
};

}  // namespace gauntlet::sim
