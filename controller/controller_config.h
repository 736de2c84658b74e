#pragma once

#include <string>
#include <vector>

#include "controller/export.h"
#include "controller/filters/filter_config.h"
#include "controller/joint_loop_config.h"
#include "controller/joint_map.h"
#include "controller/linearisation/linearisation_config.h"
#include "controller/model_predictive/model_predictive_config.h"
#include "controller/motor_rounding_config.h"
#include "controller/prediction/prediction_config.h"
#include "controller/sample_guard_config.h"
#include "controller/settings.h"
#include "controller/timing.h"

namespace gauntlet::controller {

/// Fewer cannot tell a late frame from the next one.
inline constexpr int kLeastFrameNumberBits = 2;
inline constexpr int kMostFrameNumberBits = 64;

/// Calibration of the glove: its channels, two known poses of each, and the converter's range.
///
///     angle_rad = low_angle_rad + (counts - low_counts) (high_angle_rad - low_angle_rad)
///                                                      / (high_counts - low_counts)
///
/// Shapes: one value per channel; of the converter's range also one for all. Errors: names that
/// appear twice, a range that is empty, poses outside it or too near each other.
struct GAUNTLET_API GloveCalibration {
  std::vector<std::string> channel_names;
  std::vector<double> low_counts;
  std::vector<double> high_counts;
  std::vector<double> low_angle_rad;
  std::vector<double> high_angle_rad;
  std::vector<double> full_scale_counts = {1023.0};  // largest value of the converter
  std::vector<double> min_counts = {0.0};            // smallest one: below 0 if it is signed
  /// Width of the frames' numbers: behind 2^bits - 1 comes 0. 64 if they never begin anew.
  int frame_number_bits = kMostFrameNumberBits;

  void Visit(SettingsVisitor& visitor);
};

/// The converter of each channel. Errors: SettingError for a range that is empty or not finite, or
/// lists of another length.
GAUNTLET_API std::vector<ConverterRange> ConvertersOf(const GloveCalibration& glove);

/// Transmission of the hand: how spools wind cables when joints turn.
///
///     spool_angle_rad = coupling (joint_angle_rad - reference_angle_rad)
///     motor_counts    = round(center_counts + counts_per_rad spool_angle_rad)
///
/// Shapes: coupling is motors x joints in row-major order, the others one value per motor or per
/// joint as named. There may be fewer motors than joints: springs decide what cables leave open.
struct GAUNTLET_API TendonTransmission {
  std::vector<std::string> joint_names;
  std::vector<std::string> motor_names;
  std::vector<double> coupling;
  /// Per joint the motor that is made for it; other motors' cables only pass. "": every cable that
  /// passes is meant to move it. An empty list: the first motor for the first joint, and so on.
  std::vector<std::string> motor_of_joint = {};
  std::vector<double> reference_angle_rad;  // per joint
  std::vector<double> joint_min_rad;        // per joint
  std::vector<double> joint_max_rad;        // per joint
  std::vector<double> counts_per_rad;       // per motor
  std::vector<int> center_counts;           // per motor
  std::vector<int> min_counts;              // per motor
  std::vector<int> max_counts;              // per motor
  bool joint_sensors = false;               // it measures its joints, see JointLoop

  /// The two directions of the second equation, for one motor; counts are not rounded here.
  double ToSpoolAngle(std::size_t motor, double motor_counts) const {
    return (motor_counts - center_counts[motor]) / counts_per_rad[motor];
  }
  double ToCounts(std::size_t motor, double spool_angle_rad) const {
    return center_counts[motor] + counts_per_rad[motor] * spool_angle_rad;
  }

  void Visit(SettingsVisitor& visitor);
};

/// Place of the filter: the paper filters raw counts.
enum class FilterOn { kCounts, kAngle };
/// When the filter steps: at every sample, or once per command frame.
enum class FilterAt { kSample, kEvent };

/// Settings that a person chooses. All other facts come from the glove and the hand.
struct GAUNTLET_API ControllerConfig {
  std::vector<FilterConfig> filters;  // applied in this order; empty is `none`
  FilterOn filter_on = FilterOn::kCounts;
  FilterAt filter_at = FilterAt::kSample;
  /// Compensates the coupling of cables that cross several joints; off, fingers drag each other.
  bool coupling_compensation = true;
  LinearisationConfig linearisation;
  PredictionConfig prediction;
  ModelPredictiveConfig model_predictive;
  JointLoopConfig joint_loop;
  MotorRoundingConfig motor;
  SampleGuardConfig untrusted;

  void Visit(SettingsVisitor& visitor);
};

/// Everything that a Controller is made from: what it does, and what it is connected to.
/// `gauntlet export` writes it as one file, so that a robot runs what was tuned.
struct GAUNTLET_API RobotConfig {
  ControllerConfig controller;
  GloveCalibration glove;
  TendonTransmission hand;
  JointMapConfig joint_map;
  Timing timing;

  void Visit(SettingsVisitor& visitor);
};

}  // namespace gauntlet::controller
