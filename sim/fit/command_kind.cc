#include "sim/fit/command_kind.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <vector>

#include "controller/assert.h"

namespace gauntlet::sim {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kFewestRows = 20;
/// RMS residual of a copy, in steps to which the values are rounded: that of both, and a margin.
constexpr double kCopySteps = 0.45;
constexpr double kCopyResidual = 1e-6;  // of values that are not rounded, over their spread
constexpr Index kLatestCopy = 5;

struct LinearFit {
  double gain = 0.0;
  double residual_share = 1.0;  // RMS residual over the standard deviation of the fitted values
};

/// Least squares of `y` by `x`, a constant and, if `has_drift`, a straight line over the rows.
LinearFit Fit(const VectorXd& x, const VectorXd& y, bool has_drift) {
  MatrixXd terms(x.size(), has_drift ? 3 : 2);
  terms.col(0) = x;
  terms.col(1).setOnes();
  if (has_drift) terms.col(2) = VectorXd::LinSpaced(x.size(), -1.0, 1.0);
  const double spread = (y.array() - y.mean()).matrix().norm();
  const double of_x = (x.array() - x.mean()).matrix().norm();
  if (!(spread > 0.0) || !(of_x > 0.0)) return {};
  const VectorXd solution = terms.colPivHouseholderQr().solve(y);
  return {.gain = solution[0], .residual_share = (y - terms * solution).norm() / spread};
}

/// `x` earlier by `rows` than `y`: the parts of both that overlap.
LinearFit FitLate(const VectorXd& x, const VectorXd& y, Index rows, bool has_drift) {
  const Index count = x.size() - std::abs(rows);
  if (count < kFewestRows) return {};
  return Fit(x.segment(std::max<Index>(0, -rows), count),
             y.segment(std::max<Index>(0, rows), count), has_drift);
}

/// Standard deviation.
double Spread(const VectorXd& values) {
  return std::sqrt((values.array() - values.mean()).square().mean());
}

/// The step to which values are rounded: the smallest distance of two different ones; far below
/// their spread for values that are not.
double StepOf(const VectorXd& values) {
  std::vector<double> sorted(values.begin(), values.end());
  std::ranges::sort(sorted);
  double step = 0.0;
  for (std::size_t i = 1; i < sorted.size(); ++i) {
    const double distance = sorted[i] - sorted[i - 1];
    if (distance > 0.0 && (step == 0.0 || distance < step)) step = distance;
  }
  return step;
}

LinearFit Best(const VectorXd& x, const VectorXd& y, Index most_rows, bool has_drift) {
  LinearFit best;
  // The step grows with the lag: a tenth of it changes little.
  for (Index rows = 0; rows <= most_rows; rows += std::max<Index>(1, rows / 10)) {
    const LinearFit fit = FitLate(x, y, rows, has_drift);
    if (fit.residual_share < best.residual_share) best = fit;
  }
  return best;
}

}  // namespace

CommandKind FindCommandKind(std::span<const double> command, std::span<const double> angle,
                            double rate_hz) {
  GAUNTLET_ASSERT(rate_hz > 0.0 && command.size() == angle.size());
  const Eigen::Map<const VectorXd> c(command.data(), std::ssize(command));
  const Eigen::Map<const VectorXd> a(angle.data(), std::ssize(angle));
  if (c.size() < kFewestRows) return CommandKind::kTarget;
  const double spread = Spread(a);
  const double step_a = StepOf(a);
  const double step_c = StepOf(c);
  const auto is_copy = [&](Index rows) {
    const LinearFit fit = FitLate(c, a, rows, false);
    const double step = std::max(step_a, std::abs(fit.gain) * step_c);
    return fit.residual_share * spread < kCopySteps * step + kCopyResidual * spread;
  };
  if (!(spread > 0.0)) return CommandKind::kTarget;
  if (is_copy(0)) return CommandKind::kCopy;
  for (Index rows = 1; rows <= kLatestCopy; ++rows) {
    if (is_copy(rows)) return rows == 1 ? CommandKind::kNextRow : CommandKind::kLaterRow;
  }
  if (is_copy(-1)) return CommandKind::kEarlierRow;

  constexpr double kLongestDelay_s = 3.0;
  constexpr Index kLatestSum = 3;
  constexpr double kGood = 0.3;    // residual share of a sum that is the angle
  constexpr double kBetter = 0.5;  // than that of a target
  constexpr double kNear = 1.5;    // factor of the gain
  VectorXd sum = c;
  for (Index n = 1; n < sum.size(); ++n) sum[n] += sum[n - 1];
  const LinearFit as_sum = Best(sum, a, kLatestSum, true);
  if (as_sum.residual_share > kGood || as_sum.gain <= 0.0) return CommandKind::kTarget;
  const auto most = std::min<Index>(c.size() / 4, std::lround(kLongestDelay_s * rate_hz));
  const LinearFit as_target = Best(c, a, most, false);
  const auto is_near = [&](double gain) {
    return as_sum.gain < kNear * gain && gain < kNear * as_sum.gain;
  };
  const bool is_better = as_sum.residual_share < kBetter * as_target.residual_share;
  if (is_near(1.0 / rate_hz) && is_better) return CommandKind::kVelocity;
  return is_better ? CommandKind::kSteps : CommandKind::kTarget;
}

std::string ProblemOf(CommandKind kind, double rate_hz) {
  switch (kind) {
    case CommandKind::kTarget:
      return "";
    case CommandKind::kCopy:
      return "its commands are copies of its angles: no delay can be told";
    case CommandKind::kNextRow:
      return fmt::format(
          "its commands are the angles of the next row: {:.3g} ms is the row, not the hand",
          1e3 / rate_hz);
    case CommandKind::kLaterRow:
      return "its commands are the angles of a later row, to the last digit: none was measured";
    case CommandKind::kEarlierRow:
      return "its commands are the angles of the row before: no delay can be told";
    case CommandKind::kSteps:
      return "its commands are steps of the angle, which give no delay as positions: sum them";
    case CommandKind::kVelocity:
      return "its commands are speeds of the angle, which give no delay as positions: sum them "
             "over the time";
  }
  return "";
}

}  // namespace gauntlet::sim
