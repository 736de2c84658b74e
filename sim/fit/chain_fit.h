#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/fit/chain_model.h"

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
  double open_ms = 0.0;  // of half the interval of the dead time: the same in all logs of a kind
  ChainEstimate lag_ms;
  ChainEstimate natural_frequency_hz;  // NaN if a first-order lag explains as much
  ChainEstimate damping_ratio;         // the same
  ChainEstimate gain;
  ChainEstimate offset_deg;         // of the angle at command 0
  ChainEstimate speed_limit_deg_s;  // NaN if none is seen
  /// Delay of motions below the limit, if the limit makes that of this log another one; else NaN.
  double unlimited_delay_ms = kNaN;
  ChainEstimate hysteresis_deg;  // whole width of the loop
  /// Its two parts, if the log distinguishes them, by the angle's curve or the motor's angle; else
  /// NaN.
  ChainEstimate motor_hysteresis_deg;  // in the motor, before the lag
  ChainEstimate lost_motion_deg;       // behind the lag
  std::string motor_problem;           // why the motor's angle gives neither; else empty
  std::string model_text;              // what the model contains, in words
  std::vector<std::string> remarks;  // sentences: what limits the values, what is withheld and why
  ChainModel model;
  std::optional<CommandClock> frames;  // steps of the model's command; none: it has no steps
  double residual_rms_deg = kNaN;
  double held_out_rms_deg = kNaN;  // of blocks of the log that the fit did not contain
  double shifted_rms_deg = kNaN;   // RMS with the delay alone
  double left_share = 0.0;         // smaller of both RMS, over that of the angle about its mean
};

/// kDelay: the delay alone. kBasic: lost motion and, where the command is faster than the angle, a
/// speed limit are the only additions to the basic chain, and no value is withheld.
enum class ChainDetail { kDelay, kBasic, kAll };

/// Length of the shortest log that can be fitted.
inline constexpr double kShortestChainLog_s = 5.0;

/// Fits the model by least squares (Levenberg-Marquardt). The start is the delay of the largest
/// correlation. The basic chain (play, lag of second order) is fitted first. Friction with stretch,
/// a third pole or a zero, a speed limit, a load and lost motion are added if held-out parts of the
/// log are predicted better: see SelectChain(). All fits are compared after the command has
/// travelled the whole width of the hysteresis. Correlated noise does not mislead these tests,
/// unlike a criterion that counts samples.
///
/// Intervals: delete-a-block jackknife over 20 stretches of the log, to first order, with Student's
/// t. It assumes only that noise is independent between stretches, which holds if the correlation
/// time is below a tenth of a stretch. A value that depends on few stretches, such as lost motion
/// on those with reversals, has fewer degrees of freedom (see DegreesOfFreedomOf()). The
/// disagreement with other models that explain the log as well, and with the same model by other
/// weights of the rows, is added in quadrature.
///
/// Values are withheld (NaN, with a sentence in `remarks`) if their interval is as wide as their
/// range, the natural frequency if a chain of third order explains the log as well, and the delay
/// if it depends on a speed limit, and so on the size of the motion.
/// Source: Busing, Meijer, van der Leeden, Statistics and Computing 9, 3-8 (1999); Cameron, Miller,
/// J. Human Resources 50, 317-372 (2015).
///
/// The command steps when its `frames` are sent, or by the clock that its own rows show (see
/// FindCommandClock()); without a clock see RefineCommand(). The uncertainty of the sending times
/// widens the interval of the dead time. The delay is always that of the straight line through the
/// rows.
///
/// Shapes: command and angle of equal length, finite. Units: degrees (or any unit that both share).
/// Errors: a log that is too short or without motion gives a ChainFit with a `problem`.
ChainFit FitChain(std::span<const double> command_deg, std::span<const double> angle_deg,
                  double rate_hz, int parts = 1, const std::optional<CommandClock>& frames = {},
                  ChainDetail detail = ChainDetail::kAll);

/// The delay alone; NaN if it is not known.
inline double FitDelay_ms(std::span<const double> command_deg, std::span<const double> angle_deg,
                          double rate_hz) {
  return FitChain(command_deg, angle_deg, rate_hz, 1, {}, ChainDetail::kDelay).delay_ms.value;
}

/// Facts of a chain that a log determines, beside the estimates themselves.
struct KnownOfLog {
  double travel_deg;       // of the angle, by the command's travel and the gain
  double rate_hz;          // of the rows
  ChainEstimate delay_ms;  // dead time and lag together
  bool has_play;           // the model contains hysteresis
  bool has_frames;         // the times of the command's steps are known
};

/// Widens the interval of the dead time by its open_ms.
void WidenDeadTime(ChainFit& fit);

/// Withholds the delay if a speed limit makes it depend on the size of the motion. `in_log`: the
/// delays of this log, "130 ms".
void WithholdLimited(const std::string& in_log, ChainFit& fit);

/// Withholds values whose interval is as wide as their range (NaN), with remarks.
void WithholdUnknown(const KnownOfLog& known, ChainFit& fit);

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
