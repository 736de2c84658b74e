#pragma once

#include <string>
#include <vector>

#include "controller/filters/filter_registry.h"
#include "controller/linearisation/linearisation_config.h"
#include "controller/motor_rounding_config.h"
#include "controller/prediction/prediction_config.h"
#include "controller/sample_guard.h"
#include "controller/settings.h"

namespace gauntlet::controller {

/// What is known of the glove: two known poses per channel, and the converter's range.
///
///     angle_rad = low_angle_rad + (counts - low_counts) (high_angle_rad - low_angle_rad)
///                                                      / (high_counts - low_counts)
///
/// Shapes: one value per channel. Errors: equal counts of both poses.
struct GloveCalibration {
  std::vector<double> low_counts;
  std::vector<double> high_counts;
  std::vector<double> low_angle_rad;
  std::vector<double> high_angle_rad;
  double full_scale_counts = 1023.0;
};

/// What is known of the hand: how spools wind cables when joints turn.
///
///     spool_angle_rad = coupling (joint_angle_rad - reference_angle_rad)
///     motor_counts    = round(center_counts + counts_per_rad spool_angle_rad)
///
/// Shapes: coupling is motors x channels in row-major order, the others one value per motor or per
/// channel as named. `coupling` is square and can be inverted.
struct TendonTransmission {
  std::vector<std::string> channel_names;
  std::vector<std::string> motor_names;
  std::vector<double> coupling;
  std::vector<double> reference_angle_rad;  // per channel
  std::vector<double> joint_min_rad;        // per channel
  std::vector<double> joint_max_rad;        // per channel
  std::vector<double> counts_per_rad;       // per motor
  std::vector<int> center_counts;           // per motor
  std::vector<int> min_counts;              // per motor
  std::vector<int> max_counts;              // per motor
};

/// Where the filter sits: the paper filters raw counts.
enum class FilterOn { kCounts, kAngle };
/// When the filter steps: at every sample, or once per command frame.
enum class FilterAt { kSample, kEvent };

/// What a person chooses. All other facts come from the glove and the hand.
struct ControllerConfig {
  std::vector<FilterConfig> filters;  // applied in this order; empty is `none`
  FilterOn filter_on = FilterOn::kCounts;
  FilterAt filter_at = FilterAt::kSample;
  /// Undo the coupling of cables that cross several joints; off, one sees fingers drag each other.
  bool coupling_compensation = true;
  LinearisationConfig linearisation;
  PredictionConfig prediction;
  MotorRoundingConfig motor;
  SampleGuardConfig untrusted;

  void Visit(SettingsVisitor& visitor);

  // Set by the program, not by a scenario's controller: sampling rate and command frame.
  double rate_hz = 1000.0;
  int samples_per_event = 20;
};

}  // namespace gauntlet::controller
