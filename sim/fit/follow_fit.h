#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

namespace gauntlet::sim {

/// Command and angle of a part in rows of even distance, without a gap.
struct FollowRows {
  Eigen::VectorXd command;
  Eigen::VectorXd angle;
};

/// How an angle follows its command in a stretch of a log.
struct FollowFit {
  bool is_known = false;      // false: too little motion, or no lag at which they are alike
  double correlation = 0.0;   // of the angle with the delayed command
  double opposite = 0.0;      // of the angle with the delayed opposite of the command
  double delay_rows = 0.0;    // below 0: the angle is ahead
  double error_rows = 0.0;    // standard error of the delay
  double gain = 1.0;          // of the angle over the delayed command
  double residual_rms = 0.0;  // with the gain and an offset
};

/// Finds the delay by least squares, with gain and offset free:
///
///     a[n] = g c(n - delay) + b,  c linear between rows
///
/// It is the delay of a FitChain(). The start is the largest correlation of all lags from -0.3 s to
/// 3 s, at most a quarter of the longest of `parts`. Of lags that are as good within 0.02, as of a
/// motion that repeats, the earliest counts, a lead after all others. `parts` are stretches of one
/// log that share delay, gain and offset, such as several short episodes.
///
/// The standard error is that of a delete-a-block jackknife over 10 blocks.
/// Source: Busing, Meijer, van der Leeden, Statistics and Computing 9, 3-8 (1999).
FollowFit FitFollowing(std::span<const FollowRows> parts, double rate_hz);

/// Correlation of angle and command by lag, over stretches that share a delay but no offset.
class CommonCorrelation {
 public:
  explicit CommonCorrelation(double rate_hz);
  void Add(const FollowRows& rows);
  /// The largest one, of lags from -0.3 s to 3 s; 0 without motion. `sign` -1: of the opposite.
  double Largest(double sign) const;

 private:
  Eigen::Index thin_;
  Eigen::Index lead_;
  Eigen::VectorXd products_, of_commands_, of_angles_;  // sums by lag
};

/// Delays at both ends of a log in which they change from part to part in one direction.
struct DelayDrift {
  double first_rows = 0.0;
  double last_rows = 0.0;
};

/// Finds a delay that drifts, as where command and angle have clocks of their own: in a log of 20 s
/// or more, in each of four parts of equal length later (or each time earlier) than in the part
/// before, by `least_rows` or more in all, and by more than chance explains at 1 %. None if a part
/// has no delay.
std::optional<DelayDrift> FindDelayDrift(const FollowRows& rows, double rate_hz, double least_rows);

/// Mean of several estimates with their standard errors, if the estimated thing itself may differ
/// from one to the next.
struct CommonValue {
  double mean = 0.0;
  double half_width = 0.0;  // of the 95 % interval
  double spread = 0.0;      // standard deviation of what is estimated
  bool differs = false;     // by more than chance explains, at 1 %
};
/// Random effects by DerSimonian and Laird, the interval by Hartung and Knapp, but never narrower
/// than without it. Source: Controlled Clinical Trials 7, 177-188 (1986); Statistics in Medicine
/// 20, 3875-3889 (2001). Precondition: values, of both as many; errors above 0.
CommonValue CommonOf(std::span<const double> values, std::span<const double> errors);

}  // namespace gauntlet::sim
