#include "sim/show/pages/error_split_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sim/score/statistics/result_cells.h"
#include "sim/show/pages/controller_rows.h"
#include "sim/study/cause_trials.h"

namespace gauntlet::sim {
namespace {

/// "-2 %", without the sign of what rounds to 0.
std::string Percent(double share) {
  if (!std::isfinite(share)) return "-";
  return fmt::format("{:.0f} %", std::round(100.0 * share) + 0.0);
}

}  // namespace

std::vector<double> ErrorByCause(const ControllerSummary& controller) {
  std::vector<double> parts;
  for (const TrackingErrorPart& part : TrackingErrorParts()) {
    parts.push_back(controller.summary[part.metric].mean);
  }
  if (!std::isfinite(parts.back())) return {};
  return parts;
}

std::vector<std::size_t> ShownCauses(const Summary& summary) {
  std::vector<std::size_t> shown;
  for (std::size_t i = 0; i < TrackingErrorParts().size(); ++i) {
    const std::size_t metric = TrackingErrorParts()[i].metric;
    const auto has_value = [&](const ControllerSummary& controller) {
      return std::isfinite(controller.summary[metric].mean);
    };
    if (!Metrics()[metric].needs_link || std::ranges::any_of(summary.controllers, has_value)) {
      shown.push_back(i);
    }
  }
  return shown;
}

ResultTable ErrorSplitTable(const Summary& summary) {
  ResultTable table{.columns = {ForPeople("of squared error")}};
  const std::vector<std::size_t> shown = ShownCauses(summary);
  for (const std::size_t cause : shown) {
    std::string heading(TrackingErrorParts()[cause].name);
    std::ranges::replace(heading, ' ', kBreak);
    table.columns.push_back(ForPeople(heading));
  }
  for (const auto& [c, name] : ControllerRows(summary)) {
    const std::vector<double> parts = ErrorByCause(summary.controllers[c]);
    const double whole = std::accumulate(
        parts.begin(), parts.end(), 0.0,
        [](double sum, double part) { return std::isfinite(part) ? sum + part : sum; });
    if (!(whole > 0.0)) continue;
    ResultRow& row = table.rows.emplace_back(ResultRow{name});
    for (const std::size_t cause : shown) {
      row.push_back(ResultCell::Text(Percent(parts[cause] / whole)));
    }
  }
  return table;
}

std::string CausesNote(const Summary& summary) {
  const std::size_t last = TrackingErrorParts().back().metric;
  const auto is_of_one = [&](const ControllerSummary& controller) {
    return controller.summary[last].count == 1;
  };
  if (summary.one_run || !std::ranges::any_of(summary.controllers, is_of_one)) return "";
  return fmt::format(
      "Causes of the squared error: first seed. Option --causes all computes them for all seeds, "
      "with {} more trials for each controller and seed.",
      kCauseHands + std::ranges::count_if(ShownCauses(summary), [](std::size_t cause) {
        return Metrics()[TrackingErrorParts()[cause].metric].needs_link;
      }));
}

}  // namespace gauntlet::sim
