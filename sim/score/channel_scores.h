#pragma once

#include <limits>

namespace gauntlet::sim {

inline constexpr double kNoScore = std::numeric_limits<double>::quiet_NaN();

/// The scores of one channel by name; a field per key of Metrics(). NaN where there is none.
struct ChannelScores {
  double tracking_rmse_deg = kNoScore;
  double delay_ms = kNoScore;
  double aligned_rmse_deg = kNoScore;
  double peak_error_deg = kNoScore;
  double jitter_rms_deg = kNoScore;
  double command_reversals_per_s = kNoScore;
};

/// Which field holds metric number `metric` of Metrics().
double ChannelScores::*MetricField(int metric);

}  // namespace gauntlet::sim
