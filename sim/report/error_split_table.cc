#include "sim/report/error_split_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sim/report/table_text.h"

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

std::string ErrorSplitTable(const Summary& summary) {
  std::string rows;
  std::string head = "of the squared error";
  std::size_t name_width = head.size();
  for (const ControllerSummary& controller : summary.controllers) {
    name_width = std::max(name_width, Width(controller.name));
  }
  head = Padded(head, name_width, false);
  constexpr std::size_t kNarrowest = 4;
  for (const TrackingErrorPart& part : TrackingErrorParts()) {
    head += "  " + Padded(std::string(part.name), std::max(kNarrowest, part.name.size()), true);
  }
  for (const ControllerSummary& controller : summary.controllers) {
    const std::vector<double> parts = ErrorByCause(controller);
    const double whole = std::accumulate(parts.begin(), parts.end(), 0.0);
    if (!(whole > 0.0)) continue;
    rows += Padded(controller.name, name_width, false);
    for (std::size_t i = 0; i < parts.size(); ++i) {
      rows += "  " + Padded(Percent(parts[i] / whole),
                            std::max(kNarrowest, TrackingErrorParts()[i].name.size()), true);
    }
    rows += "\n";
  }
  return rows.empty() ? "" : head + "\n" + rows;
}

}  // namespace gauntlet::sim
