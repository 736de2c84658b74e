#pragma once

#include <optional>
#include <vector>

#include "sim/calibrate/chain_fit.h"
#include "sim/calibrate/chain_log.h"
#include "sim/hand/hand_config.h"

namespace gauntlet::sim {

/// A servo of kind ideal and what rubs behind it: all that a log decides of a simulated hand.
struct AnsweringServo {
  double dead_time_ms = 0.0;
  double damping_ms = 0.0;
  double inertia_scale = 1.0;
  double full_torque_error_deg = 1.5;
  double friction_scale = 0.0;                       // of spools
  double capstan_friction = 0.0;                     // of cables
  std::vector<double> motor_friction_scale = {1.0};  // on both: one for all motors, or for each

  /// The hand `usual`, but with this servo.
  HandConfig PutInto(const HandConfig& usual) const;
};

/// What a simulated hand with such a servo made of a log's commands.
struct ServoTrial {
  AnsweringServo servo;
  ChainLog answer;
  std::vector<ChainFit> fits;  // of the answer
};

/// The servo with which the simulated hand's answer to the log's commands gives the fits that the
/// log gave: in the median over the parts of the answer nothing is missing of the dead time, lags
/// are what they were, and each part has its hysteresis. Up to eight trials, from `first` on: each
/// corrects what the last one missed, the best counts.
///
/// Friction begins with that of `usual`, and each motor's own, that of its spool and of its cables
/// together, grows and falls with the hysteresis of the joint of its name; motors of whose joint
/// the log does not tell it have the median of the others. That of spools alone would not do: where
/// cables pass several joints, a spool turns back at other moments than its joint, so that its
/// friction is seen as error of all kinds, and only in part as hysteresis; that of cables is felt
/// at the joint itself.
///
/// None if no part of the log is a joint of the model, or no such hand can be simulated.
std::optional<ServoTrial> TryServos(const ChainLog& log, const std::vector<ChainFit>& fits,
                                    const AnsweringServo& first, const HandConfig& usual);

}  // namespace gauntlet::sim
