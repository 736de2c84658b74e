#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "sim/score/latency.h"
#include "sim/study/summary.h"
#include "sim/trial/joint_angles.h"

namespace gauntlet::sim {

/// What is measured on the traces of the first seed, per controller; empty if none were kept, and
/// then the page has neither curves nor latencies. All angles are those of the measured joints,
/// ticks x joints [rad].
struct FirstSeed {
  Signal reference_rad;
  std::vector<WayOfAngles> ways;
  std::vector<Signal> hand_rad;
  std::vector<std::optional<LatencyBudget>> latency;  // as LatencyOfTrace() gives them
};

/// Everything that the scripts of a report page show, besides the settings: scores of controllers,
/// joints, motors and cables with intervals, ranks and marks, and latencies and curves of the first
/// seed.
nlohmann::ordered_json PageData(const FinishedStudy& finished, const FirstSeed& first_seed);

}  // namespace gauntlet::sim
