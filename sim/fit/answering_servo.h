#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/fit/chain_fit.h"
#include "sim/fit/chain_log.h"
#include "sim/hand/hand_config.h"
#include "sim/hand/hand_model.h"

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

/// Finds the servo with which the angles of the simulated hand are nearest to those of logs, by
///
///     miss^2 = mean over logs and parts of mean square of (measured less simulated)
///              / mean square of the motion
///
/// behind the first 0.5 s, with the median delay of the logs. Dead time only shifts the answer of a
/// servo of kind ideal, so it follows from the delay of an answer without it; a delay out of its
/// reach adds to the miss. `start` is returned if it misses less than 5 % of the motion, with that
/// delay within 10 ms. Else the ranges of damping, gain and friction are searched on the first 6 s
/// of the first log, by 80 answers, then around the best by 40 answers of all logs (optimise.h).
///
/// Friction is one factor on the scales of all motors of `start`. All logs have the same parts.
/// None if no part of the log is a joint of the model, no such hand can be simulated, or the best
/// one misses as much as a hand at rest.
std::optional<AnsweringServo> SearchServo(const std::vector<ChainLog>& logs,
                                          const AnsweringServo& start, const HandConfig& usual);

/// The servo of kind ideal that explains a log, from the equations of the model without a trial.
/// None if no part of the log has a model.
///
/// Such a servo is a chain of ServoInput, Servo and Spool: dead time, dry friction f against the
/// servo's gain K, and
///
///     J z'' = K (q - z) - K damping z'
///
/// So dead_time_ms and damping_ms are the fitted dead time and lag, full_torque_error_deg is
/// inertia_s2 stall / J, and f is K times half the width of the loop at the spool. J is the inertia
/// of the model's spools times the inertia_scale of the usual servo, so that torques are usual; the
/// fingers' inertia is neglected. no_load_speed_deg_s is the speed limit, if most parts have one.
/// All values are medians over the half of the parts with the best-known lag, because the hand has
/// one servo for all motors. Motors of arm_servo are left out. A first-order lag becomes a
/// second-order lag with a damping ratio of 1.5.
std::optional<AnsweringServo> UntriedServo(const ChainLog& log, const std::vector<ChainFit>& fits,
                                           const HandModel& hand);

/// The part of a scenario (`hand:` and `event:`) with which the simulated hand answers commands
/// like the hand of a log, with comments. TryServos() refines it if parts of the log are joints of
/// the simulated hand, and reports its `progress`. Empty if no part of the log has a model.
std::string ServoSettingsText(const ChainLog& log, const HandModel& hand,
                              const ChainProgress& progress = {});

/// Longest part of a log that is simulated, and highest rate of the answer's rows.
inline constexpr double kLongestAnswer_s = 30.0;
inline constexpr double kMostAnswerRows_hz = 250.0;
/// Beginning of an answer that is not compared with the log, because the hand's state is unknown.
inline constexpr double kNotCompared_s = 0.5;

/// Answer of the simulated hand to the commands of a log. Commands are sent in frames as in a
/// scenario, without delay of the link. Between the log's rows a command is interpolated linearly
/// or held.
///
/// The motors' angles are the joint angles for their spools, with cables that neither stretch nor
/// go slack. The answer contains the parts that are joints of the model with a motor of
/// `hand.servo`. The model's other joints stay in the middle of their ranges. The row distance is
/// about that of the log. No rows: no part is such a joint, or the hand was stopped.
/// Errors: UserError for a hand that cannot be built.
ChainLog SimulatedAnswer(const ChainLog& log, const HandConfig& hand);

}  // namespace gauntlet::sim
