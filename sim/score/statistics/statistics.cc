#include "sim/score/statistics/statistics.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <unsupported/Eigen/SpecialFunctions>

#include "controller/number.h"
#include "sim/base/student.h"
#include "sim/score/tracking.h"

namespace gauntlet::sim {
namespace {

struct Sample {
  std::vector<double> deviations;  // from the mean
  double mean = controller::kNaN;
  double scatter = controller::kNaN;  // standard deviation, n - 1

  int size() const { return static_cast<int>(deviations.size()); }
  double squares() const {
    double sum = 0.0;
    for (const double value : deviations) sum += value * value;
    return sum;
  }
};

Sample FiniteValues(std::span<const double> values) {
  Sample sample;
  for (const double value : values) {
    if (std::isfinite(value)) sample.deviations.push_back(value);
  }
  const int count = sample.size();
  if (count == 0) return sample;
  const auto [least, most] =
      std::minmax_element(sample.deviations.begin(), sample.deviations.end());
  const double smallest = *least;  // as origin: equal values give exactly their mean and no scatter
  const bool equal = *least == *most;
  double sum = 0.0;
  for (const double value : sample.deviations) sum += value - smallest;
  sample.mean = equal ? smallest : smallest + sum / count;
  for (double& value : sample.deviations) value -= sample.mean;
  if (count > 1) sample.scatter = std::sqrt(sample.squares() / (count - 1));
  return sample;
}

MeanEstimate EstimateOf(const Sample& sample) {
  MeanEstimate estimate{.mean = sample.mean, .count = sample.size()};
  if (sample.size() < 2) return estimate;
  estimate.standard_error = sample.scatter / std::sqrt(sample.size());
  estimate.degrees_of_freedom = sample.size() - 1;
  return estimate;
}

/// The share of the motions in the variance; NaN where every motion has one value.
double MotionShare(const std::vector<Sample>& motions) {
  const auto groups = static_cast<double>(motions.size());
  double count = 0.0, sum = 0.0, counts_squared = 0.0, within = 0.0;
  for (const Sample& motion : motions) {
    const double n = motion.size();
    count += n;
    counts_squared += n * n;
    sum += n * motion.mean;
    within += motion.squares();
  }
  if (count <= groups) return controller::kNaN;
  double between = 0.0;
  for (const Sample& motion : motions) {
    between += motion.size() * (motion.mean - sum / count) * (motion.mean - sum / count);
  }
  const double noise = within / (count - groups);
  const double effective_count = (count - counts_squared / count) / (groups - 1.0);
  const double motion = std::max(0.0, (between / (groups - 1.0) - noise) / effective_count);
  return motion + noise > 0.0 ? motion / (motion + noise) : controller::kNaN;
}

}  // namespace

MeanInterval MeanEstimate::IntervalAt(double level) const {
  MeanInterval interval{.mean = mean, .count = count, .level = level, .motion_share = motion_share};
  if (std::isnan(standard_error)) return interval;
  interval.degrees_of_freedom = degrees_of_freedom;
  const double half_width =
      standard_error > 0.0 ? StudentHalfWidth(level, degrees_of_freedom) * standard_error : 0.0;
  interval.low = mean - half_width;
  interval.high = mean + half_width;
  return interval;
}

MeanEstimate EstimateMean(std::span<const double> values, std::span<const int> motions) {
  std::map<int, std::vector<double>> groups;
  for (std::size_t i = 0; i < motions.size(); ++i) groups[motions[i]].push_back(values[i]);
  if (groups.size() < 2) return EstimateOf(FiniteValues(values));
  std::vector<Sample> of_motions;
  std::vector<double> means;
  int count = 0;
  for (const auto& [motion, group] : groups) {
    Sample sample = FiniteValues(group);
    if (sample.size() == 0) continue;
    count += sample.size();
    means.push_back(sample.mean);
    of_motions.push_back(std::move(sample));
  }
  MeanEstimate estimate = EstimateOf(FiniteValues(means));
  estimate.count = count;
  if (of_motions.size() > 1) estimate.motion_share = MotionShare(of_motions);
  return estimate;
}

MeanEstimate EstimateDifference(std::span<const double> first, std::span<const double> second,
                                std::span<const int> motions) {
  return EstimateMean(Differences(first, second), motions);
}

MeanEstimate EstimateUnpairedDifference(std::span<const double> first,
                                        std::span<const double> second) {
  const Sample a = FiniteValues(first);
  const Sample b = FiniteValues(second);
  MeanEstimate estimate{.mean = a.mean - b.mean, .count = a.size() + b.size()};
  if (a.size() < 2 || b.size() < 2) return estimate;
  const double a_variance = a.scatter * a.scatter / a.size();
  const double b_variance = b.scatter * b.scatter / b.size();
  const double variance = a_variance + b_variance;
  estimate.standard_error = std::sqrt(variance);
  if (variance == 0.0) return estimate;
  estimate.degrees_of_freedom =
      variance * variance /
      (a_variance * a_variance / (a.size() - 1) + b_variance * b_variance / (b.size() - 1));
  return estimate;
}

double PairedEffectSize(std::span<const double> first, std::span<const double> second) {
  const Sample sample = FiniteValues(Differences(first, second));
  return sample.scatter > 0.0 ? sample.mean / sample.scatter : controller::kNaN;
}

namespace {

/// The chance of at least so many hits, of which each has this chance.
double ChanceOfHits(int at_least, int count, double chance) {
  return Eigen::numext::betainc<double>(at_least, count - at_least + 1.0, chance);
}

/// The share at which ChanceOfHits() equals `goal`.
double ChanceWhere(int at_least, int count, double goal) {
  double low = 0.0;
  double high = 1.0;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (ChanceOfHits(at_least, count, middle) < goal ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

Share EstimateShare(int hits, int count) {
  constexpr double kEachSide = 0.025;
  Share share{.hits = hits, .count = count};
  if (hits > 0) share.low = ChanceWhere(hits, count, kEachSide);
  if (hits < count) share.high = ChanceWhere(hits + 1, count, 1.0 - kEachSide);
  return share;
}

}  // namespace gauntlet::sim
