#pragma once

#include <optional>
#include <span>
#include <string>

#include "sim/calibrate/chain_model.h"

namespace gauntlet::sim {

/// A value and its interval of 95 %; NaN: not to be had from this log.
struct ChainEstimate {
  double value = kNaN;
  double low = kNaN;
  double high = kNaN;
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
  /// Its parts, where the angle's curve or the motor's angle tells them apart; NaN where not.
  ChainEstimate motor_hysteresis_deg;  // of the motor's own way, before the lag
  ChainEstimate lost_motion_deg;       // behind it
  std::string motor_problem;           // why the motor's angle tells neither; else empty
  ChainModel model;
  std::optional<FrameClock> frames;  // in which the model's command steps; none: it does not
  double residual_rms_deg = kNaN;
  double shifted_rms_deg = kNaN;  // with the delay alone
};

/// Shortest log that a chain is fitted to.
inline constexpr double kShortestChainLog_s = 5.0;

/// Fits the model by least squares (Levenberg and Marquardt), from where the largest correlation
/// lies: first without lost motion, then with it, compared from where the command has gone the
/// whole width of the hysteresis on. Play before the lag rounds the corners of the angle, lost
/// motion leaves them sharp. The fit with lost motion counts if chance makes it as
/// much better in 5 % (Student's t of what it takes off the squares of each of the 20 stretches),
/// and if chance makes as much lost motion, for its standard error, in 5 % in any of the `parts` of
/// a hand that are asked at once (Bonferroni). Noise that is correlated does not deceive that, as
/// it would a criterion that counts samples.
///
/// Intervals: delete-a-block jackknife over 20 stretches of the log, to first order, with Student's
/// t: it knows nothing of the noise but that stretches are independent of each other, which noise
/// that is correlated over less than a tenth of a stretch is. Of a value that few stretches tell,
/// as of lost motion those with turns, t has fewer degrees of freedom (see DegreesOfFreedomOf()).
/// Source: Busing, Meijer, van der Leeden, Statistics and Computing 9, 3-8 (1999); Cameron, Miller,
/// J. Human Resources 50, 317-372 (2015).
///
/// A command steps when its `frames` are sent, if given, or the clock that its own rows tell (see
/// FindFrameClock()); else see RefineCommand(). What a clock leaves open of when they were sent
/// widens the interval of the dead time. The delay is that of the line through the rows, whichever
/// it is.
///
/// Shapes: command and angle as long, finite. Units: degrees (or whatever both share).
/// A log that does not bear it (nothing moves, too short) gives a ChainFit with a `problem`.
ChainFit FitChain(std::span<const double> command_deg, std::span<const double> angle_deg,
                  double rate_hz, int parts = 1, const std::optional<FrameClock>& frames = {});

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
              std::span<const double> angle_deg, double rate_hz, ChainFit& fit, int parts = 1);

}  // namespace gauntlet::sim
