#pragma once

#include <memory>
#include <vector>

#include "controller/filters/filter.h"
#include "controller/prediction/adaptive_prediction.h"
#include "controller/prediction/measurement_noise.h"

namespace gauntlet::controller {

/// A mixture of a predictor whose weights were fitted to one task, f, and of the general one, g, by
/// how far each has missed of late. So unlike motion, which the weights never saw, is predicted as
/// without them.
///
///     miss_f(k) = mean of (z(k) - y_f(k - h))^2 over about `memory_ms`, in units of r; miss_g too
///     y(k) = (s_f y_f(k) + s_g y_g(k)) / (s_f + s_g),   s = miss^-3
///
/// The rule is that of AdaptivePredictionConfig, which is g, with its bounds, memory and r. A miss
/// starts as r. A channel without a horizon has no fallback.
///
/// Errors: SettingError.
std::unique_ptr<Filter> WithFallback(std::unique_ptr<Filter> fitted,
                                     const AdaptivePredictionConfig& general, double rate_hz);

/// The settings of weights with a fallback.
inline void VisitFallback(SettingsVisitor& visitor, bool& fallback, std::vector<double>& r_deg2) {
  visitor.Flag({"fallback",
                "mix with the prediction adaptive by how far each has missed of late, for motion "
                "unlike the recordings; needs horizon_ms"},
               fallback);
  VisitMeasurementNoise(visitor, r_deg2);
}

}  // namespace gauntlet::controller
