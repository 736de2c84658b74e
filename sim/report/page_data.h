#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "sim/score/latency.h"
#include "sim/study/summary.h"

namespace gauntlet::sim {

/// What is measured on the traces of the first seed, per controller; empty if none were kept, and
/// then the page has neither curves nor latencies.
struct FirstSeed {
  std::vector<Signal> command_angle_rad;              // as CommandAngles() gives them
  std::vector<std::optional<LatencyBudget>> latency;  // as LatencyOfTrace() gives them
};

/// Everything that the scripts of a report page show, besides the settings: scores of controllers
/// and channels with intervals, ranks and marks, and latencies and curves of the first seed.
nlohmann::ordered_json PageData(const Scenario& scenario, const StudyResult& result,
                                const Summary& summary, const FirstSeed& first_seed,
                                bool comparison);

}  // namespace gauntlet::sim
