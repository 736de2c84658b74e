#pragma once

#include <vector>

#include "controller/settings.h"

namespace gauntlet::controller {

/// The setting of predictors that weigh what they measure.
inline void VisitMeasurementNoise(SettingsVisitor& visitor, std::vector<double>& r_deg2) {
  visitor.Numbers({.key = "r_deg2",
                   .help = "variance of the noise that is still in the angle, one for all channels "
                           "or one for each",
                   .min = 0,
                   .max = 1e6,
                   .open_range = true},
                  r_deg2);
}

}  // namespace gauntlet::controller
