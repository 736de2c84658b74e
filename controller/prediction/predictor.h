#pragma once

#include <memory>

#include "controller/filters/filter.h"
#include "controller/prediction/prediction_config.h"

namespace gauntlet::controller {

/// The predictor as a filter from angles to angles [rad]; null for the kind none.
/// Errors: SettingError, also for a linear window shorter than two steps.
std::unique_ptr<Filter> MakePredictor(const PredictionConfig& config, int channel_count,
                                      double rate_hz);

}  // namespace gauntlet::controller
