#include "sim/fit/follow_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "controller/assert.h"
#include "sim/base/student.h"

namespace gauntlet::sim {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kLead_s = 0.3;
constexpr double kLongest_s = 3.0;
constexpr double kCoarse_hz = 50.0;  // enough to find the peak
constexpr double kLeastCorrelation = 0.5;
constexpr double kAsGood = 0.02;
constexpr Index kFewestRowsOfLag = 10;

/// Sums of pairs of the command, at a lag of whole rows and the row before, and the angle.
struct Sums {
  double count = 0.0;
  double c = 0.0, d = 0.0, a = 0.0;  // command, the row before it, angle
  double cc = 0.0, dd = 0.0, aa = 0.0, cd = 0.0, ca = 0.0, da = 0.0;

  void Add(double command, double before, double angle) {
    count += 1.0;
    c += command;
    d += before;
    a += angle;
    cc += command * command;
    dd += before * before;
    aa += angle * angle;
    cd += command * before;
    ca += command * angle;
    da += before * angle;
  }

  Sums& operator+=(const Sums& o) { return Combine(o, 1.0); }
  Sums& operator-=(const Sums& o) { return Combine(o, -1.0); }

 private:
  Sums& Combine(const Sums& o, double sign) {
    count += sign * o.count;
    c += sign * o.c;
    d += sign * o.d;
    a += sign * o.a;
    cc += sign * o.cc;
    dd += sign * o.dd;
    aa += sign * o.aa;
    cd += sign * o.cd;
    ca += sign * o.ca;
    da += sign * o.da;
    return *this;
  }
};

/// Covariances of the command between two rows, `w` of the way to the row before.
struct Moments {
  Moments(const Sums& s, double w) {
    const double v = 1.0 - w;
    mean_c = (v * s.c + w * s.d) / s.count;
    mean_a = s.a / s.count;
    var_c = (v * v * s.cc + 2.0 * v * w * s.cd + w * w * s.dd) / s.count - mean_c * mean_c;
    var_a = s.aa / s.count - mean_a * mean_a;
    cov = (v * s.ca + w * s.da) / s.count - mean_c * mean_a;
  }
  /// Mean square that is left with the best gain and offset.
  double Left() const { return var_c > 0.0 ? var_a - cov * cov / var_c : var_a; }
  double Gain() const { return var_c > 0.0 ? cov / var_c : 0.0; }
  double Correlation() const {
    return var_c > 0.0 && var_a > 0.0 ? cov / std::sqrt(var_c * var_a) : 0.0;
  }

  double mean_c, mean_a, var_c, var_a, cov;
};

constexpr Index kFine = 3;  // rows on both sides of the start of the fine search
constexpr std::size_t kJackknifeBlocks = 10;
using FineSums = std::array<Sums, 2 * kFine + 1>;  // by lag

/// The place of the smallest residual: lag in rows from the first of `sums`; none at an end.
struct Minimum {
  double rows = 0.0;
  Moments moments;
};

/// Share of the way to the row before with the smallest residual: it falls and rises once.
double BestShare(const Sums& sums) {
  constexpr double kGolden = 0.381966011250105;
  double low = 0.0, high = 1.0;
  double x = kGolden, y = 1.0 - kGolden;
  double at_x = Moments(sums, x).Left(), at_y = Moments(sums, y).Left();
  for (int i = 0; i < 30; ++i) {
    if (at_x < at_y) {
      high = y;
      y = x;
      at_y = at_x;
      x = low + kGolden * (high - low);
      at_x = Moments(sums, x).Left();
    } else {
      low = x;
      x = y;
      at_x = at_y;
      y = high - kGolden * (high - low);
      at_y = Moments(sums, y).Left();
    }
  }
  return 0.5 * (low + high);
}

Minimum MinimumOf(const FineSums& all) {
  Minimum best{.moments = Moments(all[kFine], 0.0)};
  double least = 0.0;
  bool any = false;
  for (std::size_t k = 0; k < all.size(); ++k) {
    const double share = BestShare(all[k]);
    const Moments moments(all[k], share);
    if (any && moments.Left() >= least) continue;
    any = true;
    least = moments.Left();
    best = {.rows = static_cast<double>(k) + share, .moments = moments};
  }
  return best;
}

/// Every n-th row, each the mean of n.
FollowRows Thinned(const FollowRows& rows, Index n) {
  if (n == 1) return rows;
  const Index count = rows.command.size() / n;
  FollowRows thin{VectorXd(count), VectorXd(count)};
  for (Index k = 0; k < count; ++k) {
    thin.command[k] = rows.command.segment(k * n, n).mean();
    thin.angle[k] = rows.angle.segment(k * n, n).mean();
  }
  return thin;
}

/// Correlation by lag, from the lead to the longest lag.
struct Correlations {
  Index first = 0;
  std::vector<double> values;
};

Correlations CorrelationsOf(std::span<const FollowRows> parts, double rate_hz) {
  Index longest = 0;
  for (const FollowRows& rows : parts) longest = std::max(longest, rows.command.size());
  const Index most = std::min<Index>(std::lround(kLongest_s * rate_hz), longest / 4);
  const Index lead = std::min<Index>(std::lround(kLead_s * rate_hz), most);
  Correlations result{.first = -lead, .values = {}};
  for (Index lag = -lead; lag <= most; ++lag) {
    Sums sums;
    for (const FollowRows& rows : parts) {
      const Index count = rows.command.size() - std::abs(lag);
      if (count < kFewestRowsOfLag) continue;
      const auto c = rows.command.segment(std::max<Index>(0, -lag), count);
      const auto a = rows.angle.segment(std::max<Index>(0, lag), count);
      sums.count += static_cast<double>(count);
      sums.c += c.sum();
      sums.a += a.sum();
      sums.cc += c.squaredNorm();
      sums.aa += a.squaredNorm();
      sums.ca += c.dot(a);
    }
    result.values.push_back(sums.count > 0.0 ? Moments(sums, 0.0).Correlation() : 0.0);
  }
  return result;
}

/// The lag of the peak that counts; none without a peak that is high enough.
std::optional<Index> PeakOf(const Correlations& correlations) {
  const std::vector<double>& r = correlations.values;
  const double most = *std::ranges::max_element(r);
  if (most < kLeastCorrelation) return std::nullopt;
  std::optional<Index> lead;  // the best of the leads
  for (std::size_t i = 0; i < r.size(); ++i) {
    const bool is_peak = (i == 0 || r[i] >= r[i - 1]) && (i + 1 == r.size() || r[i] >= r[i + 1]);
    if (!is_peak || r[i] < most - kAsGood) continue;
    const Index lag = correlations.first + static_cast<Index>(i);
    if (lag >= -1) return lag;
    if (!lead || r[i] > r[static_cast<std::size_t>(*lead - correlations.first)]) lead = lag;
  }
  return lead;
}

}  // namespace

CommonCorrelation::CommonCorrelation(double rate_hz)
    : thin_(std::max<Index>(1, std::lround(rate_hz / kCoarse_hz))),
      lead_(std::lround(kLead_s * rate_hz / static_cast<double>(thin_))) {
  const auto last = std::lround(kLongest_s * rate_hz / static_cast<double>(thin_));
  products_ = of_commands_ = of_angles_ = VectorXd::Zero(lead_ + last + 1);
}

void CommonCorrelation::Add(const FollowRows& rows) {
  const FollowRows thin = Thinned(rows, thin_);
  for (Index i = 0; i < products_.size(); ++i) {
    const Index lag = i - lead_;
    const Index count = thin.command.size() - std::abs(lag);
    if (count < kFewestRowsOfLag || 4 * count < 3 * thin.command.size()) continue;
    const auto c = thin.command.segment(std::max<Index>(0, -lag), count);
    const auto a = thin.angle.segment(std::max<Index>(0, lag), count);
    const double rows_of_lag = static_cast<double>(count);
    products_[i] += c.dot(a) - c.sum() * a.sum() / rows_of_lag;
    of_commands_[i] += c.squaredNorm() - c.sum() * c.sum() / rows_of_lag;
    of_angles_[i] += a.squaredNorm() - a.sum() * a.sum() / rows_of_lag;
  }
}

double CommonCorrelation::Largest(double sign) const {
  double most = 0.0;
  for (Index i = 0; i < products_.size(); ++i) {
    const double norm = std::sqrt(of_commands_[i] * of_angles_[i]);
    if (norm > 0.0) most = std::max(most, sign * products_[i] / norm);
  }
  return most;
}

FollowFit FitFollowing(std::span<const FollowRows> parts, double rate_hz) {
  GAUNTLET_ASSERT(rate_hz > 0.0);
  FollowFit fit;
  const Index thin = std::max<Index>(1, std::lround(rate_hz / kCoarse_hz));
  std::vector<FollowRows> coarse;
  Index rows_in_all = 0;
  for (const FollowRows& rows : parts) {
    GAUNTLET_ASSERT(rows.command.size() == rows.angle.size());
    coarse.push_back(Thinned(rows, thin));
    rows_in_all += rows.command.size();
  }
  const Correlations correlations = CorrelationsOf(coarse, rate_hz / static_cast<double>(thin));
  if (correlations.values.size() < 3 || rows_in_all < 2 * kFewestRowsOfLag) return fit;
  fit.correlation = *std::ranges::max_element(correlations.values);
  fit.opposite = -*std::ranges::min_element(correlations.values);
  const auto peak = PeakOf(correlations);
  if (!peak) return fit;
  // A few rows of a thinned log are wide in its rows.
  Index middle = *peak * thin;
  std::vector<FineSums> blocks;
  FineSums all;
  Minimum best{.moments = Moments(Sums{.count = 1.0}, 0.0)};
  for (int tries = 0; tries < 2 + static_cast<int>(thin); ++tries) {
    blocks.assign(kJackknifeBlocks, FineSums());
    Index row = 0;
    for (const FollowRows& rows : parts) {
      const Index first = std::max<Index>(0, middle + kFine + 1);
      const Index end = rows.command.size() + std::min<Index>(0, middle - kFine);
      for (Index n = 0; n < rows.command.size(); ++n, ++row) {
        if (n < first || n >= end) continue;
        FineSums& block = blocks[static_cast<std::size_t>(
            row * static_cast<Index>(kJackknifeBlocks) / rows_in_all)];
        for (Index k = -kFine; k <= kFine; ++k) {
          const Index at = n - middle - k;
          block[static_cast<std::size_t>(k + kFine)].Add(rows.command[at], rows.command[at - 1],
                                                         rows.angle[n]);
        }
      }
    }
    all = {};
    for (const FineSums& block : blocks) {
      for (std::size_t k = 0; k < all.size(); ++k) all[k] += block[k];
    }
    if (all[0].count < static_cast<double>(kFewestRowsOfLag)) return fit;
    best = MinimumOf(all);
    const double off = best.rows - static_cast<double>(kFine);
    if (std::abs(off - 0.5) < static_cast<double>(kFine) - 0.6) break;
    middle += off > 0.0 ? kFine - 1 : 1 - kFine;
  }
  fit.delay_rows = static_cast<double>(middle - kFine) + best.rows;
  std::vector<double> without;
  for (const FineSums& block : blocks) {
    if (block[0].count < 2.0) continue;
    FineSums rest = all;
    for (std::size_t k = 0; k < rest.size(); ++k) rest[k] -= block[k];
    if (rest[0].count < static_cast<double>(kFewestRowsOfLag)) continue;
    without.push_back(MinimumOf(rest).rows);
  }
  if (without.size() < 3) return fit;
  const auto count = static_cast<double>(without.size());
  double mean = 0.0;
  for (const double value : without) mean += value / count;
  double squares = 0.0;
  for (const double value : without) squares += (value - mean) * (value - mean);
  constexpr double kLeastError_rows = 1e-3;  // no row tells more
  fit.error_rows = std::max(std::sqrt((count - 1.0) / count * squares), kLeastError_rows);
  fit.correlation = best.moments.Correlation();
  fit.gain = best.moments.Gain();
  fit.residual_rms = std::sqrt(std::max(best.moments.Left(), 0.0));
  fit.is_known = fit.correlation >= kLeastCorrelation;
  return fit;
}

CommonValue CommonOf(std::span<const double> values, std::span<const double> errors) {
  GAUNTLET_ASSERT(!values.empty() && values.size() == errors.size());
  const auto count = static_cast<double>(values.size());
  const auto weighted = [&](double variance_between, double& sum) {
    double mean = 0.0;
    sum = 0.0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double weight = 1.0 / (errors[i] * errors[i] + variance_between);
      sum += weight;
      mean += weight * values[i];
    }
    return mean / sum;
  };
  CommonValue result;
  double sum = 0.0;
  const double fixed = weighted(0.0, sum);
  constexpr double kOfOne = 9.0;  // degrees of freedom of the jackknife's 10 blocks
  if (values.size() == 1) {
    return {.mean = fixed, .half_width = StudentHalfWidth(0.95, kOfOne) * errors[0]};
  }
  double q = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double weight = 1.0 / (errors[i] * errors[i]);
    q += weight * (values[i] - fixed) * (values[i] - fixed);
    squares += weight * weight;
  }
  const double between = std::max(0.0, (q - (count - 1.0)) / (sum - squares / sum));
  result.spread = std::sqrt(between);
  // Chi-square at 1 % by Wilson and Hilferty; twice as much, because each error is an estimate.
  const double share = 2.0 / (9.0 * (count - 1.0));
  const double limit = (count - 1.0) * std::pow(1.0 - share + 2.326 * std::sqrt(share), 3);
  result.differs = q > 2.0 * limit;
  result.mean = weighted(between, sum);
  double knapp = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    knapp += (values[i] - result.mean) * (values[i] - result.mean) /
             (errors[i] * errors[i] + between) / (count - 1.0);
  }
  result.half_width = StudentHalfWidth(0.95, count - 1.0) * std::sqrt(std::max(knapp, 1.0) / sum);
  return result;
}

std::optional<DelayDrift> FindDelayDrift(const FollowRows& rows, double rate_hz,
                                         double least_rows) {
  constexpr Eigen::Index kParts = 4;
  constexpr double kShortest_s = 20.0;
  if (static_cast<double>(rows.command.size()) < kShortest_s * rate_hz) return std::nullopt;
  const Eigen::Index length = rows.command.size() / kParts;
  std::vector<double> delays, errors;
  for (Eigen::Index part = 0; part < kParts; ++part) {
    const FollowRows of_part = {rows.command.segment(part * length, length),
                                rows.angle.segment(part * length, length)};
    const FollowFit fit = FitFollowing({&of_part, 1}, rate_hz);
    if (!fit.is_known || !(fit.error_rows > 0.0)) return std::nullopt;
    delays.push_back(fit.delay_rows);
    errors.push_back(fit.error_rows);
  }
  const bool is_one_way = std::ranges::is_sorted(delays, std::ranges::less_equal()) ||
                          std::ranges::is_sorted(delays, std::ranges::greater_equal());
  if (!is_one_way || std::abs(delays.back() - delays.front()) < least_rows ||
      !CommonOf(delays, errors).differs) {
    return std::nullopt;
  }
  return DelayDrift{delays.front(), delays.back()};
}

}  // namespace gauntlet::sim
