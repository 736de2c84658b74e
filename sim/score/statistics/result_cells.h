#pragma once

#include <string>
#include <vector>

#include "sim/base/json.h"
#include "sim/results/result_table.h"
#include "sim/score/statistics/judgement.h"
#include "sim/score/statistics/statistics.h"

namespace gauntlet::sim {

/// Name of a score in sentences: "tracking error"; the key of one without such a name.
std::string ScoreName(std::size_t metric);
/// Name of a score as the head of a column, a word below the other.
std::string ScoreHeading(std::size_t metric);
/// "4.45 deg RMS"
std::string ScoreValue(std::size_t metric, double value);
/// "tracking error 4.45 deg RMS"; empty for no value.
std::string NamedScore(std::size_t metric, double value);

/// A mean with its interval: {"mean", "ci95_low", "ci95_high"} in JSON, KEY, KEY_low and KEY_high
/// in CSV.
ResultColumn MeanColumn(const std::string& key, const std::string& heading);
/// One of each metric; they stand below `group` in JSON.
std::vector<ResultColumn> MetricColumns(const std::vector<std::size_t>& metrics,
                                        const std::string& group);

/// A difference with its interval, its level and what it means: {"mean", "low", "high", "level",
/// "verdict"} in JSON; in CSV the last one at most, under this name.
ResultColumn DifferenceColumn(const std::string& key, const std::string& heading,
                              const std::string& verdict = {});

/// A mean and half of its interval, `4.96±0.12`; "-" where there is none.
std::string IntervalText(const MeanInterval& interval);
ResultCell CellOf(const MeanInterval& interval);
/// `verdict`: also the text for people.
ResultCell CellOf(const MeanInterval& difference, std::string_view verdict);

/// {"mean", "ci95_low", "ci95_high"}.
Json JsonOf(const MeanInterval& interval);

}  // namespace gauntlet::sim
