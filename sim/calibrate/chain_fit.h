#pragma once

#include <optional>
#include <span>
#include <string>

#include "sim/calibrate/chain_model.h"

namespace gauntlet::sim {

/// A value and its 95 % interval; NaN if the log does not determine it.
struct ChainEstimate {
  double value = kNaN;
  double low = kNaN;
  double high = kNaN;
};

/// The fitted chain of one part (joint or motor) of a hand.
struct ChainFit {
  /// The reason why the fit failed; empty if it did not.
  std::string problem;

  /// Time shift with the smallest RMS difference between command and angle. A prediction must look
  /// ahead by this delay in motions of this kind.
  ChainEstimate delay_ms;
  /// The reason why the following values are missing; empty if they are known.
  std::string split_problem;
  ChainEstimate dead_time_ms;
  ChainEstimate lag_ms;
  ChainEstimate natural_frequency_hz;  // NaN if a first-order lag explains as much
  ChainEstimate damping_ratio;         // the same
  ChainEstimate gain;
  ChainEstimate hysteresis_deg;  // whole width of the loop
  /// Its two parts, if the log distinguishes them, by the angle's curve or the motor's angle; else
  /// NaN.
  ChainEstimate motor_hysteresis_deg;  // in the motor, before the lag
  ChainEstimate lost_motion_deg;       // behind the lag
  std::string motor_problem;           // why the motor's angle gives neither; else empty
  ChainModel model;
  std::optional<FrameClock> frames;  // steps of the model's command; none: it has no steps
  double residual_rms_deg = kNaN;
  double shifted_rms_deg = kNaN;  // RMS with the delay alone
};

/// Length of the shortest log that can be fitted.
inline constexpr double kShortestChainLog_s = 5.0;

/// Fits the model by least squares (Levenberg-Marquardt). The start is the delay of the largest
/// correlation. The first fit is without lost motion, the second with it. Both are compared after
/// the command has travelled the whole width of the hysteresis. Play before the lag rounds the
/// corners of the angle; lost motion leaves them sharp.
///
/// The fit with lost motion is accepted if two tests at 5 % reject chance. The first is Student's t
/// of the reduction of squares in each of 20 stretches. The second compares the lost motion with
/// its standard error, for all `parts` of a hand together (Bonferroni). Correlated noise does not
/// mislead these tests, unlike a criterion that counts samples.
///
/// Intervals: delete-a-block jackknife over 20 stretches of the log, to first order, with Student's
/// t. It assumes only that noise is independent between stretches, which holds if the correlation
/// time is below a tenth of a stretch. A value that depends on few stretches, such as lost motion
/// on those with reversals, has fewer degrees of freedom (see DegreesOfFreedomOf()).
/// Source: Busing, Meijer, van der Leeden, Statistics and Computing 9, 3-8 (1999); Cameron, Miller,
/// J. Human Resources 50, 317-372 (2015).
///
/// The command steps when its `frames` are sent, or by the clock that its own rows show (see
/// FindFrameClock()); without a clock see RefineCommand(). The uncertainty of the sending times
/// widens the interval of the dead time. The delay is always that of the straight line through the
/// rows.
///
/// Shapes: command and angle of equal length, finite. Units: degrees (or any unit that both share).
/// Errors: a log that is too short or without motion gives a ChainFit with a `problem`.
ChainFit FitChain(std::span<const double> command_deg, std::span<const double> angle_deg,
                  double rate_hz, int parts = 1, const std::optional<FrameClock>& frames = {});

/// Adds the values that the motor's angle determines to a part's fit. Scale, offset and sign of
/// that angle do not matter.
///
/// Lost motion is the motor's travel after a reversal before the joint follows, in degrees of the
/// joint. It is the width of the loop between both angles, by a ChainModel without lag. Its causes
/// are dead zones (backlash of a gear, cable slack) and cables that stretch before they slide on
/// their guides. All of them hold the joint while the motor turns, so they look alike. A joint that
/// a load holds at one end of a dead zone does not cross it, and little motion is lost although not
/// all parts are tight. Noise of the motor's angle increases the value, because its extremes count.
///
/// Intervals as in FitChain(). The lower end of the lost motion is reduced by the possible
/// contribution of noise.
/// Shapes: all of equal length, finite.
void AddMotor(std::span<const double> command_deg, std::span<const double> motor_deg,
              std::span<const double> angle_deg, double rate_hz, ChainFit& fit, int parts = 1);

}  // namespace gauntlet::sim
