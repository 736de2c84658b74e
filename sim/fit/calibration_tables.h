#pragma once

#include <optional>
#include <string>

#include "controller/calibration/predictor_fit.h"
#include "sim/fit/calibration.h"
#include "sim/results/table_text.h"

namespace gauntlet::sim {

/// The answer of a calibration: error and R, and the file that contains them. A row per channel;
/// `chosen`: the curve in the file; `verbose` adds the other curves and the intervals of R.
ResultText CalibrationText(const Calibration& calibration, const CurveErrors& errors,
                           CurveKind chosen, const std::string& file, bool verbose);
std::string CalibrationJson(const Calibration& calibration, const CurveErrors& errors);

/// The change within the horizon that the fit leaves, noise included. `held_out`: the same of
/// recordings that were not fitted to, if there are any; `unit`: of the motion that was fitted;
/// `verbose` adds noise and the error of the fit itself.
ResultText PredictorFitText(const PoseRecording& recording, const controller::PredictorFit& fit,
                            const std::optional<controller::PredictionErrors>& held_out,
                            const std::string& unit, const std::string& file, bool verbose);

}  // namespace gauntlet::sim
