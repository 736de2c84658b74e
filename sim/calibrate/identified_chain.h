#pragma once

#include <string>
#include <vector>

#include "controller/controller_config.h"
#include "controller/settings.h"
#include "sim/calibrate/chain_log.h"

namespace gauntlet::sim {

/// What `gauntlet identify` writes of one joint or motor. Lists are the value and the ends of its
/// 95 % interval; empty: not to be had from the log.
struct IdentifiedPart {
  std::string part;
  std::vector<double> delay_ms;
  std::vector<double> dead_time_ms;
  std::vector<double> lag_ms;
  std::vector<double> natural_frequency_hz;
  std::vector<double> damping_ratio;
  std::vector<double> gain;
  std::vector<double> hysteresis_deg;
  std::vector<double> motor_hysteresis_deg;  // this and the next: parts of it, where told apart
  std::vector<double> lost_motion_deg;
  double residual_rms_deg = 0.0;  // 0 if the model was not fitted

  void Visit(controller::SettingsVisitor& visitor);
};

/// Of the delay, how far a prediction looks ahead. At the whole delay, noise and turns of the
/// motion cost more than the last fifth brings: tracking and jitter over this share are in
/// tests/measurements/README.md.
inline constexpr double kHorizonShare = 0.8;

/// The chain from a command to the angles of a hand. The first lists are settings of a controller,
/// in the order of `parts`: one without a value of its own has the mean of the others.
struct IdentifiedChain {
  std::string log;                   // that it was made from
  std::vector<double> horizon_ms;    // of a prediction: kHorizonShare of the delay
  double expected_delay_ms = 0.0;    // of a joint loop: its mean
  std::vector<double> friction_deg;  // of a joint loop: half the hysteresis
  // Of model_predictive, for a log that begins with commands; empty if no part tells of it.
  std::vector<double> dead_time_ms;
  std::vector<double> lag_ms;
  std::vector<double> natural_frequency_hz;
  std::vector<IdentifiedPart> parts;

  void Visit(controller::SettingsVisitor& visitor);
};

IdentifiedChain MakeIdentifiedChain(const ChainLog& log, const std::vector<ChainFit>& fits);

/// Lets the prediction of a controller look as far ahead as the chain is late: for each channel by
/// the part of its name, or else by the mean of the joints that the joint map lets it move.
/// Errors: SettingError for a channel of which the chain tells nothing, or a controller without a
/// prediction that has a horizon, or with planned commands, which look ahead by themselves.
void UseChain(const IdentifiedChain& chain, const std::vector<std::string>& channel_names,
              const controller::JointMapConfig& joint_map, controller::ControllerConfig& config);

}  // namespace gauntlet::sim
