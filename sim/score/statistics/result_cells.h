#pragma once

#include <cstddef>
#include <string>
#include <string_view>
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

/// True if people get no interval: it has at most three replicates (of two Student's t is 12.7) and
/// is wider to each side than `size`, the value that it belongs to or the score that it is a
/// difference of.
bool IsOfTooFew(const MeanInterval& interval, double size);
/// As people get it: without limits where it IsOfTooFew().
MeanInterval ShownInterval(MeanInterval interval, double size);
/// "2 seeds: too few for some intervals, use --seeds 8.": of an interval that IsOfTooFew().
/// `option` gives more of the `seeds`.
std::string TooFewText(const MeanInterval& few, std::size_t seeds,
                       std::string_view option = "--seeds 8");
/// TooFewText() of the first that IsOfTooFew() for its own mean; empty without one.
std::string TooFewTextIfAny(const std::vector<MeanInterval>& intervals, std::size_t seeds,
                            std::string_view option = "--seeds 8");

/// A mean and half of its interval, `4.96±0.12`, with no more than three digits of the mean and two
/// of the half, which is never 0 for a width above 0; without the half where ShownInterval() has
/// none, "-" where there is no mean.
std::string IntervalText(const MeanInterval& interval);
ResultCell CellOf(const MeanInterval& interval);
/// `verdict`: also the text for people.
ResultCell CellOf(const MeanInterval& difference, std::string_view verdict);

/// {"mean", "ci95_low", "ci95_high"}.
Json JsonOf(const MeanInterval& interval);

}  // namespace gauntlet::sim
