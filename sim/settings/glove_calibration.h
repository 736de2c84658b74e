#pragma once

#include <string>
#include <vector>

#include "controller/controller_config.h"
#include "controller/settings.h"

namespace gauntlet::sim {

/// Calibration of one channel.
struct ChannelCalibration {
  std::string channel;
  // Curve: errors over all settled samples, sensor noise included.
  double rms_error_deg = 0.0;
  double largest_error_deg = 0.0;
  std::vector<double> half_width_95_deg;  // see controller::CurveFit; empty if unknown
  // Noise while the hand is still.
  double variance_counts2 = 0.0;
  double variance_low_counts2 = 0.0;
  double variance_high_counts2 = 0.0;
  bool hidden_by_rounding = false;         // see controller::NoiseEstimate::rounded
  int spikes = 0;                          // removed from the still stretches
  double neighbour_correlation = 0.0;      // lag-one autocorrelation; 0 for white noise
  std::vector<double> covariance_counts2;  // with every channel
  std::vector<double> covariance_low_counts2;
  std::vector<double> covariance_high_counts2;

  void Visit(controller::SettingsVisitor& visitor);
};

/// Calibration of one glove: the curves from counts to angles, and the measurement covariance R.
/// `gauntlet calibrate` writes it, and a controller of a scenario includes it.
struct Calibration {
  std::string recording;  // source
  int samples = 0;
  double rate_hz = 1000.0;
  double confidence_percent = 95.0;  // of the intervals of R
  double resolution_counts = 1.0;    // quantisation step of the values; 0: none
  double degrees_of_freedom = 1.0;   // still samples minus still stretches
  /// The kind is kGlove, without channels, if the recording has no known angles.
  controller::LinearisationConfig linearisation;
  std::vector<ChannelCalibration> channels;

  void Visit(controller::SettingsVisitor& visitor);
};

/// Copies the calibration of the named channels into a controller's settings: the linearisation, if
/// there is one and `take_linearisation` is set, and R into the filters that `take_r` selects.
/// Filters get variances, `kalman_dense` the full covariance. Quantisation noise is a lower bound.
/// Errors: SettingError for a channel without calibration, or for a filter on angles, because R is
/// in counts^2.
void UseCalibration(const Calibration& calibration, const std::vector<std::string>& channel_names,
                    bool take_linearisation, const std::vector<bool>& take_r,
                    controller::ControllerConfig& config);

}  // namespace gauntlet::sim
