#pragma once

#include <memory>
#include <string_view>

#include "controller/filters/filter.h"
#include "controller/settings.h"

namespace gauntlet::controller {

/// Position plus horizon times velocity of a Kalman filter with white acceleration of density q and
/// measurement variance r, at its settled gain.
///
/// Source: Bai, Jiang, Yokoi, section 5; q and r are assumptions that fit motions of 0.5 to 1 Hz
/// and 45 deg.
struct KalmanPredictionConfig {
  static constexpr std::string_view kKind = "kalman";
  static constexpr std::string_view kSummary =
      "along the velocity of a Kalman filter with white acceleration";

  double horizon_ms = 45.0;  // the paper's bound of the event time
  double q_deg2_per_s3 = 1e4;
  double r_deg2 = 0.5;

  void Visit(SettingsVisitor& visitor);
};

/// Errors: SettingError.
std::unique_ptr<Filter> MakePredictor(const KalmanPredictionConfig& config, int channel_count,
                                      double rate_hz);

}  // namespace gauntlet::controller
