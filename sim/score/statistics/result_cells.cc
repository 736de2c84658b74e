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

std::string IntervalText(const MeanInterval& interval) {
  if (std::isnan(interval.mean)) return "-";
  if (std::isnan(interval.high)) return fmt::format("{:.3g}", interval.mean);
  return fmt::format("{:.3g}±{:.2g}", interval.mean, interval.high - interval.mean);
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
