#pragma once

#include <Eigen/Core>
#include <limits>
#include <span>
#include <string>

namespace gauntlet::sim {

/// What stands between a command and the angle that follows it: dead time, then play, as dry
/// friction against a soft servo makes it, then a lag of second order.
///
///     v(t) = gain u(t - dead_time)
///     q    = clamp(q, v - play, v + play)               the width of its loop is 2 play
///     y    = z + offset,   inertia z'' + lag z' + z = q
///
/// Slow motions are late by dead_time + lag, and by what the play adds. The natural frequency is
/// 1 / (2 pi sqrt(inertia)), the damping ratio lag / (2 sqrt(inertia)).
///
/// Dry friction and the backlash of a gear look alike here: what is left after a turn, is one
/// number. Source: model of play: Tao, Kokotovic, Automatica 29, 323-335 (1993).
struct ChainModel {
  double dead_time_s = 0.0;
  double lag_s = 0.0;
  double inertia_s2 = 0.0;
  double gain = 1.0;
  double play_deg = 0.0;
  double offset_deg = 0.0;
};

/// The angle that the model gives for a command, which is a straight line between samples; exact
/// for it but for the corner where play ends within a step. Before the first sample all stands
/// still. Shapes: both as long.
void SimulateChain(const ChainModel& model, std::span<const double> command_deg, double rate_hz,
                   std::span<double> angle_deg);

/// A value and its interval of 95 %; NaN: not to be had from this log.
struct ChainEstimate {
  double value = std::numeric_limits<double>::quiet_NaN();
  double low = std::numeric_limits<double>::quiet_NaN();
  double high = std::numeric_limits<double>::quiet_NaN();
};

/// What a log says of one part of a hand.
struct ChainFit {
  /// Why there is nothing else here; empty if there is.
  std::string problem;

  /// The shift in time that makes command and angle most alike: how far a prediction has to look
  /// ahead in motions like this one.
  ChainEstimate delay_ms;
  /// Why there is nothing of what follows; empty if there is.
  std::string split_problem;
  ChainEstimate dead_time_ms;
  ChainEstimate lag_ms;
  ChainEstimate natural_frequency_hz;  // NaN where a lag of first order says as much
  ChainEstimate damping_ratio;         // the same
  ChainEstimate gain;
  ChainEstimate hysteresis_deg;  // all of the loop's width
  /// Of a log that also has the motor's angle, in degrees of the joint; NaN of others.
  ChainEstimate motor_hysteresis_deg;  // the part of it that the motor's own way has
  ChainEstimate lost_motion_deg;       // what AddMotor() finds behind it
  std::string motor_problem;           // why there is neither; empty if there is, or no motor
  ChainModel model;
  double residual_rms_deg = std::numeric_limits<double>::quiet_NaN();
  double shifted_rms_deg = std::numeric_limits<double>::quiet_NaN();  // with the delay alone
};

/// Shortest log that a chain is fitted to.
inline constexpr double kShortestChainLog_s = 5.0;

/// Fits the model by least squares (Levenberg and Marquardt), from where the largest correlation
/// lies.
///
/// Intervals: delete-a-block jackknife over 20 stretches of the log, to first order, with Student's
/// t: it knows nothing of the noise but that stretches are independent of each other, which noise
/// that is correlated over less than a tenth of a stretch is. Source: Busing, Meijer, van der
/// Leeden, Statistics and Computing 9, 3-8 (1999); Cameron, Miller, J. Human Resources 50, 317-372
/// (2015).
///
/// Shapes: command and angle as long, finite. Units: degrees (or whatever both share).
/// A log that does not bear it (nothing moves, too short) gives a ChainFit with a `problem`.
ChainFit FitChain(std::span<const double> command_deg, std::span<const double> angle_deg,
                  double rate_hz);

/// Adds to a part's fit what its motor's angle tells. Its scale, zero and sense do not matter.
///
/// Lost motion is how far the motor turns at a reversal before the joint follows, in degrees of the
/// joint: the width of the loop between their angles, by a ChainModel without lag. Dead zones make
/// it, as the play of a gear and slack of cables, and cables that stretch before they slide on
/// their guides: all hold the joint where it is while the motor turns, so they look alike. A joint
/// that a load holds at one end of a dead zone crosses none of it: then little is lost, and not all
/// tight. Noise of the motor's angle adds to it, as the extremes of what it says count.
///
/// Intervals as of FitChain(); that of lost motion begins lower by what noise may have added.
/// Shapes: all as long, finite.
void AddMotor(std::span<const double> command_deg, std::span<const double> motor_deg,
              std::span<const double> angle_deg, double rate_hz, ChainFit& fit);

}  // namespace gauntlet::sim
