#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "controller/filters/filter.h"
#include "controller/filters/filter_config.h"

namespace gauntlet::sim {

/// A filter alone, for samples that may be missing. A filter gets finite numbers only, and none so
/// large that a sum of them is not finite: any other value (NaN, or beyond 1e100) is the last good
/// one of its channel again. Before the first good value of a channel the output is NaN, and its
/// filter starts there.
///
/// Shapes: rows have a value per channel; input and output are the same memory, or do not overlap.
/// Errors: SettingError, as MakeFilter().
class HeldFilter {
 public:
  HeldFilter(const controller::FilterConfig& config, int channel_count, double rate_hz);

  /// One sample of every channel.
  void Step(std::span<const double> input, std::span<double> output);
  /// Many samples, row behind row. The same values as of Step() for each row.
  void StepRows(std::span<const double> input, std::span<double> output);

  /// Number of values that were held, or are missing before the first good one.
  std::size_t held() const { return held_; }

 private:
  std::unique_ptr<controller::Filter> filter_;
  std::vector<double> values_;  // the last good ones
  std::vector<bool> started_;   // had a good value
  bool all_started_ = false;
  std::size_t held_ = 0;
};

/// Some filters count samples, as a median does; others have cutoffs in Hz.
bool DependsOnRate(const controller::FilterConfig& config, int channel_count);

}  // namespace gauntlet::sim
