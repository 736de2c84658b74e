#pragma once

#include <vector>

#include "sim/fit/pose_recording.h"
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

}  // namespace gauntlet::sim
