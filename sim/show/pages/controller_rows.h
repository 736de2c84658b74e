#pragma once

#include <cstddef>
#include <vector>

#include "sim/answers/compare/summary.h"
#include "sim/results/result_table.h"

namespace gauntlet::sim {

/// A controller's place in a summary, and its name as tables have it.
struct ControllerRow {
  std::size_t controller;
  ResultCell name;  // in its colour
};

/// All controllers in the order of the verdict, which is that of every table and chart.
std::vector<ControllerRow> ControllerRows(const Summary& summary);

}  // namespace gauntlet::sim
