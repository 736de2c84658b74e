#pragma once

#include <optional>
#include <vector>

#include "sim/fit/chain_fit.h"
#include "sim/fit/chain_log.h"
#include "sim/hand/hand_config.h"

namespace gauntlet::sim {

/// A servo of kind ideal and the friction behind it: the settings of a hand that a log determines.
struct AnsweringServo {
  double dead_time_ms = 0.0;
  double damping_ms = 0.0;
  double inertia_scale = 1.0;
  double full_torque_error_deg = 1.5;
  double no_load_speed_deg_s = 0.0;                  // 0: no limit
  double friction_scale = 0.0;                       // friction of spools
  double capstan_friction = 0.0;                     // friction of cables
  std::vector<double> motor_friction_scale = {1.0};  // on both; one for all motors or one each

  /// The hand `usual` with this servo.
  HandConfig PutInto(const HandConfig& usual) const;
};

/// The answer of a simulated hand with such a servo to the commands of a log.
struct ServoTrial {
  AnsweringServo servo;
  ChainLog answer;
  std::vector<ChainFit> fits;  // of the simulated answer
};

/// Finds the servo with which the fits of the simulated answer equal the fits of the log: dead time
/// and lag in the median over the parts, also the speed limit where parts have one, and hysteresis
/// for each part. Makes up to eight trials,
/// beginning with `first`. Each trial corrects the differences of the last one; the best trial is
/// returned.
///
/// The friction of spools and cables begins with that of `usual`. One scale per motor applies to
/// both and follows the hysteresis of the joint with the motor's name. Motors of joints without a
/// known hysteresis have the median of the other scales. Friction of the spools alone would not be
/// enough. Where cables cross several joints, a spool reverses at other moments than its joint, so
/// its friction appears only in part as hysteresis. Friction of the cables acts at the joint
/// itself.
///
/// `progress` hears how many of the trials are done, before each.
/// None if no part of the log is a joint of the model, or if no such hand can be simulated.
std::optional<ServoTrial> TryServos(const ChainLog& log, const std::vector<ChainFit>& fits,
                                    const AnsweringServo& first, const HandConfig& usual,
                                    const ChainProgress& progress = {});

}  // namespace gauntlet::sim
