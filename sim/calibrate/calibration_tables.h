#pragma once

#include <optional>
#include <string>

#include "controller/calibration/predictor_fit.h"
#include "sim/calibrate/calibration.h"
#include "sim/results/table_text.h"

namespace gauntlet::sim {

/// A calibration, a row per channel; `chosen`: the curve in the file.
ResultText CalibrationText(const Calibration& calibration, const CurveErrors& errors,
                           CurveKind chosen);
std::string CalibrationJson(const Calibration& calibration, const CurveErrors& errors);

/// What the fit takes away of the change within the horizon, noise included. `held_out`: the same
/// of recordings that were not fitted to, if there are any; `unit`: of the motion that it was
/// fitted to.
ResultText PredictorFitText(const PoseRecording& recording, const controller::PredictorFit& fit,
                            const std::optional<controller::PredictionErrors>& held_out,
                            const std::string& unit);

}  // namespace gauntlet::sim
