#include "sim/report/error_split_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sim/statistics/result_cells.h"

namespace gauntlet::sim {
namespace {

/// "-2 %", without the sign of what rounds to 0.
std::string Percent(double share) {
  return fmt::format("{:.0f} %", std::round(100.0 * share) + 0.0);
}

}  // namespace

std::vector<double> ErrorByCause(const ControllerSummary& controller) {
  std::vector<double> parts;
  for (const TrackingErrorPart& part : TrackingErrorParts()) {
    parts.push_back(controller.summary[part.metric].mean);
    if (!std::isfinite(parts.back())) return {};
  }
  return parts;
}

ResultTable ErrorSplitTable(const Summary& summary) {
  ResultTable table{.columns = {ForPeople("of the squared error")}};
  for (const TrackingErrorPart& part : TrackingErrorParts()) {
    std::string heading(part.name);
    std::ranges::replace(heading, ' ', kBreak);
    table.columns.push_back(ForPeople(heading));
  }
  for (const ControllerSummary& controller : summary.controllers) {
    const std::vector<double> parts = ErrorByCause(controller);
    const double whole = std::accumulate(parts.begin(), parts.end(), 0.0);
    if (!(whole > 0.0)) continue;
    ResultRow& row = table.rows.emplace_back(ResultRow{ResultCell::Text(controller.name)});
    for (const double part : parts) row.push_back(ResultCell::Text(Percent(part / whole)));
  }
  return table;
}

}  // namespace gauntlet::sim
