#pragma once

#include <optional>
#include <string>
#include <vector>

#include "controller/calibration/predictor_fit.h"
#include "sim/fit/pose_recording.h"
#include "sim/results/table_text.h"
#include "sim/settings/glove_calibration.h"

namespace gauntlet::sim {

enum class CurveKind { kTable, kTwoPoint, kPolynomial };

struct CalibrationOptions {
  CurveKind curve = CurveKind::kTable;
  int degree = 3;  // of the polynomial
  double confidence_percent = 95.0;
};

/// RMS error of a kind of curve over the settled samples of all channels; NaN if it cannot be
/// fitted.
struct CurveErrors {
  std::vector<double> two_point_rms_deg;
  std::vector<double> polynomial_rms_deg;
  std::vector<double> table_rms_deg;
};

/// Fits the curves to the settled poses and estimates R from the still stretches
/// (controller/calibration). `errors` receives the errors of the other kinds of curves.
/// Errors: UserError with the recording and the channel, if the data are not sufficient for the
/// curve or the hand is never still.
Calibration Calibrate(const PoseRecording& recording, const CalibrationOptions& options,
                      CurveErrors& errors);

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
