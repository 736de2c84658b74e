#include "sim/score/statistics/blocks.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

#include "controller/assert.h"

namespace gauntlet::sim {
namespace {

constexpr int kMostBlocks = 16;
constexpr double kShortestBlock_s = 5.0;
constexpr double kWantedTimes = 4.0;  // correlation times of a block
constexpr double kFewestTimes = 2.0;

double MeanOfAll(std::span<const double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

}  // namespace

double AutocorrelationTime(std::span<const std::vector<double>> series) {
  const std::size_t count = series.empty() ? 0 : series.front().size();
  if (count < 2) return 1.0;
  std::vector<std::vector<double>> deviations(series.begin(), series.end());
  for (std::vector<double>& one : deviations) {
    GAUNTLET_ASSERT(one.size() == count);
    const double mean = MeanOfAll(one);
    for (double& value : one) value -= mean;
  }
  const auto products = [&](std::size_t lag) {
    double sum = 0.0;
    for (const std::vector<double>& one : deviations) {
      for (std::size_t n = 0; n + lag < count; ++n) sum += one[n] * one[n + lag];
    }
    return sum;
  };
  const double variation = products(0);
  if (!(variation > 0.0)) return 1.0;
  double sum = 0.0;
  std::size_t lags = 0;
  while (lags + 1 < count) {
    const double pair = (products(lags) + products(lags + 1)) / variation;
    if (!(pair > 0.0)) break;
    sum += pair;
    lags += 2;
  }
  const double time = std::max(1.0, 2.0 * sum - 1.0);
  return time * (1.0 + static_cast<double>(lags) / static_cast<double>(count));
}

double BlockPlan::Widening() const {
  return count == 0 ? 1.0 : 1.0 / std::sqrt(1.0 - correlation_s / (2.0 * length_s));
}

BlockPlan PlanBlocks(double duration_s, double correlation_s, int fewest) {
  BlockPlan plan{.correlation_s = correlation_s};
  plan.needed_s = fewest * std::max(kShortestBlock_s, kFewestTimes * correlation_s);
  if (duration_s < plan.needed_s) return plan;
  const double wanted_s = std::max(kShortestBlock_s, kWantedTimes * correlation_s);
  plan.count = std::clamp(static_cast<int>(duration_s / wanted_s), fewest, kMostBlocks);
  plan.length_s = duration_s / plan.count;
  return plan;
}

std::vector<double> BlockValues(double whole, std::span<const double> without, double widening) {
  const double mean = MeanOfAll(without);
  const double size = (static_cast<double>(without.size()) - 1.0) * widening;
  std::vector<double> values;
  for (const double one : without) values.push_back(whole + size * (mean - one));
  return values;
}

}  // namespace gauntlet::sim
