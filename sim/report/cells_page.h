#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "sim/study/robust.h"
#include "sim/study/tune.h"

namespace gauntlet::sim {

/// How many points the pictures of a page have at most. A page of that many stays below 3 MB.
inline constexpr std::int64_t kPagePoints = 2000;

/// Pages of `gauntlet sweep`, `tune` and `robust`, each self-contained as ReportPage() is: `table`,
/// which is what the terminal shows, and pictures, which stand there without scripts: a heat map
/// per pair of settings, parallel coordinates, jitter against delay, and tornadoes. With scripts
/// ranges can be brushed, and a click gives a point's settings as YAML and the command that repeats
/// it. Of more than kPagePoints points the pictures have the best half of that many, and of the
/// others one in equal steps; heat maps have all. See sim/report/README.md.
std::string SweepPage(const SweepPlan& plan, SweepDatabase& database, const CellRange& cells,
                      const SweepSummary& summary, const std::string& table);
std::string RobustPage(const RobustPlan& plan, SweepDatabase& database, const RobustResult& result,
                       const std::string& table);
std::string TunePage(const TunePlan& plan, const TuneResult& result, const std::string& table);

/// Settings `key=value` as a scenario has them: a level per part of the key. What stands in a list
/// becomes a comment, as its neighbours are not known.
std::string SettingsYaml(std::vector<std::string> overrides);

}  // namespace gauntlet::sim
