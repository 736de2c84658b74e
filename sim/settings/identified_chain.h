#pragma once

#include <string>
#include <vector>

#include "controller/controller_config.h"
#include "controller/settings.h"

namespace gauntlet::sim {

/// Results of `gauntlet identify` for one joint or motor. A list has the value and the ends of its
/// 95 % interval; it is empty if the log does not determine the value.
struct IdentifiedPart {
  std::string part;
  std::vector<double> delay_ms;
  std::vector<double> dead_time_ms;
  std::vector<double> lag_ms;
  std::vector<double> natural_frequency_hz;
  std::vector<double> damping_ratio;
  std::vector<double> gain;
  std::vector<double> offset_deg;
  std::vector<double> speed_limit_deg_s;
  std::vector<double> hysteresis_deg;
  std::vector<double> motor_hysteresis_deg;  // this and the next: parts of hysteresis_deg
  std::vector<double> lost_motion_deg;
  double residual_rms_deg = 0.0;  // 0 without a fitted model, as the next
  double held_out_rms_deg = 0.0;
  std::string model;    // what the fitted model contains
  std::string remarks;  // what limits the values, what is withheld and why

  void Visit(controller::SettingsVisitor& visitor);
};

/// Horizon of a prediction as a share of the delay. The last fifth costs more, by noise and
/// reversals, than it gains: see tracking and jitter over this share in
/// docs/evidence/measurements.md.
inline constexpr double kHorizonShare = 0.8;

/// The chain from a command to the angles of a hand. The first lists are settings of a controller
/// in the order of `parts`. A part without a value has the mean of the others; a list is empty if
/// no part has a value, and the lists in degrees are empty if the log's unit is unknown.
struct IdentifiedChain {
  std::string log;                   // source
  std::vector<double> horizon_ms;    // prediction: kHorizonShare times delay
  double expected_delay_ms = 0.0;    // joint loop: mean delay; 0 if no part has one
  std::vector<double> friction_deg;  // joint loop: half the hysteresis
  // For model_predictive, if the log begins with commands; empty if no part has a value.
  std::vector<double> dead_time_ms;
  std::vector<double> lag_ms;
  std::vector<double> natural_frequency_hz;
  std::vector<IdentifiedPart> parts;

  void Visit(controller::SettingsVisitor& visitor);
};

/// Sets the prediction horizon of a controller from the delay of the chain. Each channel takes the
/// delay of the part of its name, or else the mean over the joints that it moves by the joint map.
/// Errors: SettingError for a channel without a delay in the chain, a controller without a
/// prediction that has a horizon, or a controller with planned commands, which look ahead by
/// themselves.
void UseChain(const IdentifiedChain& chain, const std::vector<std::string>& channel_names,
              const controller::JointMapConfig& joint_map, controller::ControllerConfig& config);

}  // namespace gauntlet::sim
