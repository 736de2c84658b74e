#pragma once

#include <Eigen/Core>
#include <vector>

#include "controller/filters/per_channel.h"
#include "controller/settings.h"

namespace gauntlet::controller {

/// The setting that every prediction has.
inline void VisitHorizon(SettingsVisitor& visitor, std::vector<double>& horizon_ms) {
  visitor.Numbers({.key = "horizon_ms",
                   .help = "how far to look ahead, one for all channels or one for each",
                   .min = 0,
                   .max = 1000},
                  horizon_ms);
}

/// The same in steps of the predictor, per channel. Errors: SettingError.
inline Eigen::ArrayXd HorizonSteps(const std::vector<double>& horizon_ms, int channel_count,
                                   double rate_hz) {
  return PerChannel("horizon_ms", horizon_ms, channel_count) * 1e-3 * rate_hz;
}

}  // namespace gauntlet::controller
