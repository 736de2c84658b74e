#pragma once

#include <string>
#include <vector>

#include "controller/controller_config.h"
#include "sim/calibrate/pose_recording.h"

namespace gauntlet::sim {

/// What a recording says of one channel.
struct ChannelCalibration {
  std::string channel;
  // Of the curve: errors over all settled samples, sensor noise included.
  double rms_error_deg = 0.0;
  double largest_error_deg = 0.0;
  std::vector<double> half_width_95_deg;  // see controller::CurveFit; empty if not to be had
  // Of the noise while the hand holds still.
  double variance_counts2 = 0.0;
  double variance_low_counts2 = 0.0;
  double variance_high_counts2 = 0.0;
  bool hidden_by_rounding = false;         // see controller::NoiseEstimate::rounded
  int spikes = 0;                          // left out, in the still stretches
  double neighbour_correlation = 0.0;      // of samples that follow each other; 0 is white noise
  std::vector<double> covariance_counts2;  // with every channel
  std::vector<double> covariance_low_counts2;
  std::vector<double> covariance_high_counts2;

  void Visit(controller::SettingsVisitor& visitor);
};

/// A calibration of one glove, as `gauntlet calibrate` writes it and a controller of a scenario
/// includes it: the curves from counts to angles, and the measurement covariance R.
struct Calibration {
  std::string recording;  // that it was made from
  int samples = 0;
  double rate_hz = 1000.0;
  double confidence_percent = 95.0;  // of the intervals of R
  double resolution_counts = 1.0;    // steps of the recorded values; 0 if not rounded
  double degrees_of_freedom = 1.0;   // still samples less still stretches
  /// kind is kGlove and there are no channels if the recording has no known angles.
  controller::LinearisationConfig linearisation;
  std::vector<ChannelCalibration> channels;

  void Visit(controller::SettingsVisitor& visitor);
};

enum class CurveKind { kTable, kTwoPoint, kPolynomial };

struct CalibrationOptions {
  CurveKind curve = CurveKind::kTable;
  int degree = 3;  // of the polynomial
  double confidence_percent = 95.0;
};

/// What a kind of curve leaves on the settled samples of every channel; NaN where it cannot be
/// fitted.
struct CurveErrors {
  std::vector<double> two_point_rms_deg;
  std::vector<double> polynomial_rms_deg;
  std::vector<double> table_rms_deg;
};

/// Fits the curves to the settled poses and estimates R from the still stretches, see
/// controller/calibration. `errors` gets what the other kinds of curves would leave.
/// Errors: UserError with the recording and the channel, if the data do not bear the curve, or if
/// the hand never holds still.
Calibration Calibrate(const PoseRecording& recording, const CalibrationOptions& options,
                      CurveErrors& errors);

/// Puts the calibration of the named channels into a controller's settings: the linearisation, if
/// it has one and `take_linearisation`, and R into the filters for which `take_r` says so:
/// variances, for `kalman_dense` the full covariance. Rounding is the least noise that there is.
/// Errors: SettingError for a channel without calibration, or a filter on angles: R is in counts.
void UseCalibration(const Calibration& calibration, const std::vector<std::string>& channel_names,
                    bool take_linearisation, const std::vector<bool>& take_r,
                    controller::ControllerConfig& config);

}  // namespace gauntlet::sim
