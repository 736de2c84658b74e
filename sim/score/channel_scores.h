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
  double rest_tracking_rmse_deg = kNoScore;
  double rest_jitter_deg = kNoScore;
  double slow_tracking_rmse_deg = kNoScore;
  double slow_jitter_rms_deg = kNoScore;
  double fast_tracking_rmse_deg = kNoScore;
  double fast_jitter_rms_deg = kNoScore;
  double onset_tracking_rmse_deg = kNoScore;
  double onset_jitter_rms_deg = kNoScore;
  double reversal_tracking_rmse_deg = kNoScore;
  double reversal_jitter_rms_deg = kNoScore;
  double sparc = kNoScore;
  double ldlj = kNoScore;
  double overshoot_deg = kNoScore;
  double onset_delay_ms = kNoScore;
  double motor_speed_rms_deg_s = kNoScore;
  double motor_speed_centroid_hz = kNoScore;
  double saturation_share = kNoScore;
  double slack_share = kNoScore;
  double tension_peak_n = kNoScore;
  double grip_force_ripple_n = kNoScore;  // of the whole hand: only in a summary
};

/// Which field holds metric number `metric` of Metrics().
double ChannelScores::*MetricField(int metric);

}  // namespace gauntlet::sim
