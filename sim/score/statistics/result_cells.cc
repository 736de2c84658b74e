#include "sim/score/statistics/result_cells.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sim/base/json.h"
#include "sim/results/table_text.h"
#include "sim/score/metrics.h"

namespace gauntlet::sim {

std::string ScoreName(std::size_t metric) {
  const Metric& named = Metrics()[metric];
  return std::string(named.name.empty() ? named.key : named.name);
}

std::string ScoreHeading(std::size_t metric) {
  std::string heading = ScoreName(metric);
  std::ranges::replace(heading, ' ', kBreak);
  return heading;
}

std::string ScoreValue(std::size_t metric, double value) {
  const std::string_view unit = Metrics()[metric].unit;
  return Short(value) + (unit.empty() ? "" : " ") + std::string(unit);
}

std::string NamedScore(std::size_t metric, double value) {
  if (!std::isfinite(value)) return "";
  return ScoreName(metric) + " " + ScoreValue(metric, value);
}

ResultColumn MeanColumn(const std::string& key, const std::string& heading) {
  return {
      key, heading, "", {{"mean", key}, {"ci95_low", key + "_low"}, {"ci95_high", key + "_high"}}};
}

std::vector<ResultColumn> MetricColumns(const std::vector<std::size_t>& metrics,
                                        const std::string& group) {
  std::vector<ResultColumn> columns;
  for (const std::size_t metric : metrics) {
    const std::string key(Metrics()[metric].key);
    ResultColumn& column = columns.emplace_back(MeanColumn(key, ScoreHeading(metric)).In(group));
    column.unit = Metrics()[metric].unit;
  }
  return columns;
}

ResultColumn DifferenceColumn(const std::string& key, const std::string& heading,
                              const std::string& verdict) {
  return {key,
          heading,
          "",
          {{"mean", ""}, {"low", ""}, {"high", ""}, {"level", ""}, {"verdict", verdict}}};
}

bool IsOfTooFew(const MeanInterval& interval, double size) {
  constexpr double kMostDegreesOfFreedom = 2.0;
  return interval.degrees_of_freedom <= kMostDegreesOfFreedom &&
         interval.high - interval.mean > std::abs(size);
}

MeanInterval ShownInterval(MeanInterval interval, double size) {
  if (IsOfTooFew(interval, size)) interval.low = interval.high = controller::kNaN;
  return interval;
}

std::string TooFewText(const MeanInterval& few, std::size_t seeds, std::string_view option) {
  const auto replicates = static_cast<std::size_t>(std::lround(few.degrees_of_freedom)) + 1;
  return replicates >= seeds
             ? fmt::format("{} seeds: too few for some intervals, use {}.", seeds, option)
             : fmt::format("{} motions: too few for some intervals, use more.", replicates);
}

std::string TooFewTextIfAny(const std::vector<MeanInterval>& intervals, std::size_t seeds,
                            std::string_view option) {
  const auto found = std::ranges::find_if(
      intervals, [](const MeanInterval& interval) { return IsOfTooFew(interval, interval.mean); });
  return found == intervals.end() ? "" : TooFewText(*found, seeds, option);
}

std::string IntervalText(const MeanInterval& interval) {
  if (std::isnan(interval.mean)) return "-";
  const double half = ShownInterval(interval, interval.mean).high - interval.mean;
  if (std::isnan(half)) return Short(interval.mean);
  if (half == 0.0) return Short(interval.mean) + "±0";
  // Digits behind the point of so many leading digits.
  const auto decimals_of = [](double value, int digits) {
    constexpr int kMost = 9;
    return value == 0.0
               ? kMost
               : std::clamp(digits - 1 - static_cast<int>(std::floor(std::log10(std::abs(value)))),
                            0, kMost);
  };
  const int decimals = std::min(decimals_of(interval.mean, 3), decimals_of(half, 2));
  const double step = std::pow(10.0, -decimals);
  const double mean = std::round(interval.mean / step) * step;
  return fmt::format("{:.{}f}±{:.{}f}", mean == 0.0 ? 0.0 : mean, decimals, std::max(half, step),
                     decimals);
}

ResultCell CellOf(const MeanInterval& interval) {
  return {{interval.mean, interval.low, interval.high}, IntervalText(interval)};
}

ResultCell CellOf(const MeanInterval& difference, std::string_view verdict) {
  return {
      {difference.mean, difference.low, difference.high, difference.level, std::string(verdict)},
      std::string(verdict == JudgementText(Judgement::kEqual) ? JudgementWord(Judgement::kEqual)
                                                              : verdict)};
}

Json JsonOf(const MeanInterval& interval) {
  return {{"mean", NumberOrNull(interval.mean)},
          {"ci95_low", NumberOrNull(interval.low)},
          {"ci95_high", NumberOrNull(interval.high)}};
}

}  // namespace gauntlet::sim
