#include "sim/fit/command_kind.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "controller/assert.h"

namespace gauntlet::sim {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kFewestRows = 20;
constexpr Index kLatestCopy = 5;
constexpr double kMixedShare = 0.05;  // of the moving rows: no chance makes runs so long

struct LinearFit {
  Index rows = 0;  // by which the angle is later
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
  return {.rows = 0, .gain = solution[0], .residual_share = (y - terms * solution).norm() / spread};
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

/// Range of the values but for one in 200, half of them at each end.
double UsualRange(std::vector<double>& values) {
  constexpr std::size_t kOneIn = 200;
  std::ranges::sort(values);
  const std::size_t off = values.size() / kOneIn / 2;
  return values[values.size() - 1 - off] - values[off];
}

/// The next lag to try: the step grows with the lag, a tenth of it changes little.
Index Later(Index rows) { return rows + std::max<Index>(1, rows / 10); }

LinearFit Best(const VectorXd& x, const VectorXd& y, Index most_rows, bool has_drift) {
  LinearFit best;
  for (Index rows = 0; rows <= most_rows; rows = Later(rows)) {
    LinearFit fit = FitLate(x, y, rows, has_drift);
    fit.rows = rows;
    if (fit.residual_share < best.residual_share) best = fit;
  }
  return best;
}

/// Angle far from its start at a constant command of 1, by
///
///     a[n + 1] - a[n] = q c[n - k] - l a[n] + b
///
/// about 1 for a target, however slowly the angle follows; beyond all bounds for a sum.
double SteadyGain(const VectorXd& c, const VectorXd& a, Index most_rows) {
  double gain = 0.0, least = 0.0;
  for (Index rows = 0; rows <= most_rows; rows = Later(rows)) {
    const Index count = c.size() - rows - 1;
    if (count < kFewestRows) break;
    MatrixXd terms(count, 3);
    terms.col(0) = c.head(count);
    terms.col(1) = a.segment(rows, count);
    terms.col(2).setOnes();
    const VectorXd change = a.segment(rows + 1, count) - a.segment(rows, count);
    const VectorXd solution = terms.colPivHouseholderQr().solve(change);
    const double left = (change - terms * solution).norm() / std::sqrt(static_cast<double>(count));
    if (rows > 0 && left >= least) continue;
    least = left;
    gain = solution[0] / -solution[1];
  }
  return gain;
}

/// True if all values have at most the 11 digits of a half float.
bool AreHalves(const VectorXd& values) {
  constexpr int kDigitsOfHalf = 11;
  return std::ranges::all_of(values, [](double value) {
    int exponent = 0;
    const double digits = std::ldexp(std::frexp(value, &exponent), kDigitsOfHalf);
    return digits == std::floor(digits);
  });
}

/// Finds commands that are the angle of another row, to their digits. Only rows in which one of
/// them changes count: at rest, a target and its angle are alike.
class CopyFinder {
 public:
  CopyFinder(const VectorXd& c, const VectorXd& a)
      : c_(c), a_(a), step_c_(StepOf(c)), step_a_(StepOf(a)), has_halves_(AreHalves(c)) {}

  /// True if the command is the angle `rows` later, but for the rounding of the command, and that
  /// of the angle if it is fine. A command with finer steps than a coarse angle comes from
  /// elsewhere.
  bool IsCopy(Index rows) const {
    std::vector<double> x, y;
    // The angle moves if it does by half of a coarse step of the command, in its unit.
    const double step_of_gain = step_c_ < kDigits * Spread(c_)
                                    ? std::numeric_limits<double>::infinity()
                                    : step_c_ * Spread(a_) / Spread(c_);
    for (Index n = 1; n < c_.size(); ++n) {
      if (n + rows < 1 || n + rows >= a_.size()) continue;
      const bool angle_moves = std::abs(a_[n + rows] - a_[n + rows - 1]) > 0.5 * step_of_gain;
      if (c_[n] == c_[n - 1] && !angle_moves) continue;
      x.push_back(c_[n]);
      y.push_back(a_[n + rows]);
    }
    constexpr std::size_t kFewest = 10;
    if (x.size() < kFewest) return false;
    const Eigen::Map<const VectorXd> command(x.data(), std::ssize(x));
    const Eigen::Map<const VectorXd> angle(y.data(), std::ssize(y));
    const double spread = Spread(command);
    const double mean_c = command.mean(), mean_a = angle.mean();
    double gain = (command.array() - mean_c).matrix().dot((angle.array() - mean_a).matrix()) /
                  (command.array() - mean_c).square().sum();
    if (!(spread > 0.0) || !(std::abs(gain) > 0.0)) return false;
    // Rounding moves the slope a little; a copy usually has its own.
    constexpr double kNearOne = 2e-3;
    const bool is_own = std::abs(std::abs(gain) - 1.0) < kNearOne;
    if (is_own) gain = std::copysign(1.0, gain);
    const double step_a = step_a_ / std::abs(gain);  // in units of the command
    const double exact = kExact * spread + (step_a < kDigits * spread ? 0.5 * step_a : 0.0);
    std::vector<double> errors, all_errors;
    double largest = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      errors.push_back((y[i] - mean_a) / gain - (x[i] - mean_c));
      largest = std::max(largest, std::abs(x[i]));
    }
    // Between two levels only, the rows that move fit anything: the others must fit, too.
    for (Index n = std::max<Index>(0, -rows); n < c_.size() && n + rows < a_.size(); ++n) {
      all_errors.push_back((a_[n + rows] - mean_a) / gain - (c_[n] - mean_c));
    }
    const double range = UsualRange(errors);
    const double margin = is_own ? 1.03 : 1.15;
    const double half = has_halves_ ? largest / 1024.0 : 0.0;  // the last digit
    const double most = margin * (2.0 * exact + step_c_ + half);
    if (range > most || UsualRange(all_errors) > most) return false;
    return step_c_ < kDigits * spread || range < 2.0 * exact || FillsSteps(rows, gain, range);
  }

  /// True if the angle is anywhere within a step of the command while the command stays: that of a
  /// rounded copy. A target that is followed well is near the step.
  bool FillsSteps(Index rows, double gain, double range) const {
    std::vector<double> errors;
    for (Index n = std::max<Index>(1, -rows); n + 1 < c_.size() && n + rows < a_.size(); ++n) {
      if (c_[n - 1] != c_[n] || c_[n + 1] != c_[n]) continue;
      errors.push_back(a_[n + rows] / gain - c_[n]);
    }
    constexpr std::size_t kFewest = 10;
    constexpr double kLeastRange = 0.7;  // of a step, in a motion that hardly stays
    if (errors.size() < kFewest) return range > kLeastRange * step_c_;
    const Eigen::Map<const VectorXd> all(errors.data(), std::ssize(errors));
    constexpr double kLeastSpread = 0.12;  // of a step; 0.29 if all places are as likely
    return Spread(all) > kLeastSpread * step_c_;
  }

 private:
  const VectorXd c_, a_;
  static constexpr double kExact = 1e-6;   // of the spread
  static constexpr double kDigits = 2e-3;  // the same: the steps are those of digits
  double step_c_, step_a_;
  bool has_halves_;
};

/// FindCopiedRows() of the angle `late` rows later.
CopiedRows CopiedRowsAt(std::span<const double> command, std::span<const double> angle,
                        std::size_t late) {
  constexpr std::size_t kShortestRun = 10;
  constexpr double kSame = 1e-6;  // of the largest value
  double largest = 0.0;
  for (const double value : command) largest = std::max(largest, std::abs(value));
  CopiedRows rows;
  std::size_t run = 0, run_begin = 0, moving_before = 0;  // moving rows before the first run
  const auto end_run = [&](std::size_t end) {
    if (run >= kShortestRun) {
      if (rows.copied == 0) {
        rows.first = run_begin;
        moving_before = rows.moving - run;
      }
      rows.copied += run;
      rows.last = end - 1;
      rows.between = rows.moving - moving_before;
    }
    run = 0;
  };
  for (std::size_t n = 1; n + late < command.size(); ++n) {
    if (std::abs(command[n] - angle[n + late]) > kSame * largest) end_run(n);
    // A quick hand may reach each step of a slow target in one row.
    if (command[n] == command[n - 1] || (late > 0 && command[n] == command[n + late])) continue;
    ++rows.moving;
    if (std::abs(command[n] - angle[n + late]) > kSame * largest) continue;
    if (run++ == 0) run_begin = n;
  }
  end_run(command.size() - late);
  return rows;
}

struct KindFacts {
  CommandKind kind;
  const char* name;
  const char* problem;  // with the place of a row's time [ms]
};

const KindFacts& FactsOf(CommandKind kind) {
  using enum CommandKind;
  static constexpr std::array<KindFacts, 9> kFacts = {{
      {kTarget, "target", ""},
      {kCopy, "copy", "its commands are copies of its angles: no delay can be told"},
      {kNextRow, "next_row",
       "its commands are the angles of the next row: {:.3g} ms is the row, not the hand"},
      {kLaterRow, "later_row",
       "its commands are the angles of a later row, to the last digit: none was measured"},
      {kEarlierRow, "earlier_row",
       "its commands are the angles of the row before: no delay can be told"},
      {kMixed, "mixed",
       "its commands are copies of its angles in some of the rows: leave these rows out"},
      {kSteps, "steps",
       "its commands are steps of the angle, which give no delay as positions: sum them"},
      {kVelocity, "velocity",
       "its commands are speeds of the angle, which give no delay as positions: sum them over the "
       "time"},
      {kChanges, "changes",
       "its commands go with the speed of its angle, and give no delay as positions: they are "
       "steps in another scale, or differences to the angle"},
  }};
  return *std::ranges::find(kFacts, kind, &KindFacts::kind);
}

}  // namespace

CopiedRows FindCopiedRows(std::span<const double> command, std::span<const double> angle) {
  GAUNTLET_ASSERT(command.size() == angle.size());
  const CopiedRows same = CopiedRowsAt(command, angle, 0), next = CopiedRowsAt(command, angle, 1);
  return next.copied > same.copied ? next : same;
}

CommandKind FindCommandKind(std::span<const double> command, std::span<const double> angle,
                            double rate_hz) {
  GAUNTLET_ASSERT(rate_hz > 0.0 && command.size() == angle.size());
  const Eigen::Map<const VectorXd> c(command.data(), std::ssize(command));
  const Eigen::Map<const VectorXd> a(angle.data(), std::ssize(angle));
  if (c.size() < kFewestRows) return CommandKind::kTarget;
  if (!(Spread(a) > 0.0) || !(Spread(c) > 0.0)) return CommandKind::kTarget;
  const CopyFinder copies(c, a);
  if (copies.IsCopy(0)) return CommandKind::kCopy;
  for (Index rows = 1; rows <= kLatestCopy; ++rows) {
    if (copies.IsCopy(rows)) return rows == 1 ? CommandKind::kNextRow : CommandKind::kLaterRow;
  }
  if (copies.IsCopy(-1)) return CommandKind::kEarlierRow;
  if (FindCopiedRows(command, angle).share() >= kMixedShare) return CommandKind::kMixed;
  constexpr double kLongestDelay_s = 3.0;
  constexpr double kLatestSum_s = 1.5;
  constexpr Index kLatestSum = 3;   // of an angle that a target explains, too
  constexpr double kGood = 0.3;     // residual share of a sum that is the angle
  constexpr double kBetter = 0.5;   // than that of a target
  constexpr double kPoor = 0.2;     // residual share of a target that explains little
  constexpr double kNear = 1.25;    // factor of the gain
  constexpr double kFlatter = 1.8;  // the same of an angle far behind
  VectorXd sum = c;
  for (Index n = 1; n < sum.size(); ++n) sum[n] += sum[n - 1];
  const auto most = [&](double longest_s) {
    return std::min<Index>(c.size() / 4, std::lround(longest_s * rate_hz));
  };
  const LinearFit as_target = Best(c, a, most(kLongestDelay_s), false);
  const bool is_poor = as_target.residual_share > kPoor;
  // Half a turn later, the sum of a motion that repeats is the motion.
  const LinearFit as_sum =
      Best(sum, a, is_poor ? std::max(kLatestSum, most(kLatestSum_s)) : kLatestSum, true);
  if (as_sum.residual_share > kGood || as_sum.gain <= 0.0) return CommandKind::kTarget;
  if (as_sum.residual_share > kBetter * as_target.residual_share) return CommandKind::kTarget;
  const double steady = SteadyGain(c, a, kLatestSum + as_sum.rows + as_sum.rows / 5);
  if (0.5 < steady && steady < 2.0) return CommandKind::kTarget;  // that is followed slowly
  // A lag flattens what it delays.
  const double flatter = as_sum.rows > kLatestSum ? kFlatter : kNear;
  const auto is_near = [&](double gain) {
    return as_sum.gain < kNear * gain && gain < flatter * as_sum.gain;
  };
  if (is_near(1.0)) return CommandKind::kSteps;
  return is_near(1.0 / rate_hz) ? CommandKind::kVelocity : CommandKind::kChanges;
}

const char* NameOf(CommandKind kind) { return FactsOf(kind).name; }

std::string ProblemOf(CommandKind kind, double rate_hz) {
  return fmt::format(fmt::runtime(FactsOf(kind).problem), 1e3 / rate_hz);
}

}  // namespace gauntlet::sim
