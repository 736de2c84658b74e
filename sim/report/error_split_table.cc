#include "sim/report/error_split_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

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

std::string ErrorSplitTable(const Summary& summary, const TerminalStyle& style) {
  std::vector<TableColumn> columns;
  for (const TrackingErrorPart& part : TrackingErrorParts()) {
    TableColumn& column = columns.emplace_back();
    for (std::size_t begin = 0; begin < part.name.size();) {  // a line for each word
      const std::size_t end = std::min(part.name.find(' ', begin), part.name.size());
      column.head.emplace_back(part.name.substr(begin, end - begin));
      begin = end + 1;
    }
  }
  std::vector<std::string> names;
  for (const ControllerSummary& controller : summary.controllers) {
    const std::vector<double> parts = ErrorByCause(controller);
    const double whole = std::accumulate(parts.begin(), parts.end(), 0.0);
    if (!(whole > 0.0)) continue;
    names.push_back(controller.name);
    for (std::size_t i = 0; i < parts.size(); ++i) {
      columns[i].rows.push_back({{.text = Percent(parts[i] / whole)}});
    }
  }
  return names.empty() ? "" : TableText("of the squared error", names, columns, style);
}

}  // namespace gauntlet::sim
