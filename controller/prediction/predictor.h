#pragma once

#include <memory>

#include "controller/export.h"
#include "controller/filters/filter.h"
#include "controller/prediction/prediction_config.h"

namespace gauntlet::controller {

/// The predictor as a filter from angles to angles [rad]; null for the kind none.
/// Errors: SettingError, also for a linear window shorter than two steps.
GAUNTLET_API std::unique_ptr<Filter> MakePredictor(const PredictionConfig& config,
                                                   int channel_count, double rate_hz);

// The same for each kind.

/// Null: there is nothing to do.
inline std::unique_ptr<Filter> MakePredictor(const NoPredictionConfig&, int, double) {
  return nullptr;
}

/// Errors: SettingError, also for a window shorter than two steps.
GAUNTLET_API std::unique_ptr<Filter> MakePredictor(const LinearPredictionConfig& config,
                                                   int channel_count, double rate_hz);

/// Errors: SettingError.
GAUNTLET_API std::unique_ptr<Filter> MakePredictor(const KalmanPredictionConfig& config,
                                                   int channel_count, double rate_hz);

/// With several `rows` the channels are so many rows of the same ones, which may differ in their
/// horizon but not in `r_deg2` or input: the filters of the bank are those of the first row, and
/// the others ask them.
/// Errors: SettingError.
GAUNTLET_API std::unique_ptr<Filter> MakePredictor(const AdaptivePredictionConfig& config,
                                                   int channel_count, double rate_hz, int rows = 1);

/// Errors: SettingError.
GAUNTLET_API std::unique_ptr<Filter> MakePredictor(const FittedPredictionConfig& config,
                                                   int channel_count, double rate_hz);

/// Errors: SettingError, always: without weights there is no predictor.
GAUNTLET_API std::unique_ptr<Filter> MakePredictor(const FittedToOthersPredictionConfig& config,
                                                   int channel_count, double rate_hz);

}  // namespace gauntlet::controller
