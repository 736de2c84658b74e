#pragma once

#include <string_view>
#include <vector>

#include "controller/export.h"
#include "controller/settings.h"

namespace gauntlet::controller {

/// Future angle of a joint if its velocity or, with three states, its acceleration stays: those of
/// a Kalman filter at its settled gain.
///
///     y = x + h v               white acceleration of density q [deg^2/s^3]
///     y = x + h v + h^2/2 a     white jerk of density q [deg^2/s^5]
///
/// Source: Bai, Jiang, Yokoi, section 5; q and r are assumptions that fit motions of 0.5 to 1 Hz
/// and 45 deg. Errors: SettingError if a list has neither one value nor one per channel.
struct GAUNTLET_API KalmanPredictionConfig {
  static constexpr std::string_view kKind = "kalman";
  static constexpr std::string_view kSummary =
      "along the velocity, or the parabola, of a Kalman filter";

  std::vector<double> horizon_ms = {45.0};  // the paper's bound of the event time
  int states = 2;
  double q_deg2_per_s3 = 1e4;  // with two states
  double q_deg2_per_s5 = 1e6;  // with three
  std::vector<double> r_deg2 = {0.5};

  void Visit(SettingsVisitor& visitor);
};

}  // namespace gauntlet::controller
