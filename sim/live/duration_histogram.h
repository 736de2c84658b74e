#pragma once

#include <cstdint>
#include <utility>
#include <vector>

namespace gauntlet::sim {

/// Durations in steps of 1 us up to 50 ms, and of 1 ms up to 60 s. Add() neither throws nor
/// allocates. A negative duration counts as 0.
class DurationHistogram {
 public:
  DurationHistogram();

  void Add(std::int64_t duration_ns) noexcept;

  std::int64_t count() const noexcept { return count_; }
  /// Exact, not of the steps; NaN without durations.
  double mean_us() const noexcept;
  double max_us() const noexcept;
  /// Upper end of the step that has this share of the durations, 0 to 1, below it or in it, at most
  /// the largest duration. NaN without durations.
  double Quantile_us(double share) const noexcept;
  /// The steps that are not empty: lower end [us], durations.
  std::vector<std::pair<double, std::int64_t>> Steps() const;

 private:
  std::vector<std::uint32_t> steps_;
  std::int64_t count_ = 0;
  std::int64_t sum_ns_ = 0;
  std::int64_t max_ns_ = 0;
};

}  // namespace gauntlet::sim
