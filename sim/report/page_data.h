#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "sim/study/summary.h"

namespace gauntlet::sim {

/// Everything that the scripts of a report page show, besides the settings: scores of controllers
/// and channels with intervals, ranks and marks, and the curves of the first seed.
/// `command_angle_rad`: per controller, as CommandAngles() gives them; empty if traces were not
/// kept, and then the page has no curves.
nlohmann::ordered_json PageData(const Scenario& scenario, const StudyResult& result,
                                const Summary& summary,
                                const std::vector<Signal>& command_angle_rad, bool comparison);

}  // namespace gauntlet::sim
