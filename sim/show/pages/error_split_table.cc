#include "sim/show/pages/error_split_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sim/score/statistics/result_cells.h"
#include "sim/show/pages/controller_rows.h"

namespace gauntlet::sim {
namespace {

/// "-2 %", without the sign of what rounds to 0.
std::string Percent(double share) {
  if (!std::isfinite(share)) return "-";
  return fmt::format("{:.0f} %", std::round(100.0 * share) + 0.0);
}

ResultColumn CauseColumn(std::string_view cause) {
  std::string heading(cause);
  std::ranges::replace(heading, ' ', kBreak);
  return ForPeople(heading);
}

}  // namespace

std::vector<double> ErrorByCause(const ControllerSummary& controller) {
  std::vector<double> parts;
  for (const CauseMetric& part : TrackingErrorParts()) {
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
    table.columns.push_back(CauseColumn(TrackingErrorParts()[cause].name));
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

std::string SharesNote(const Summary& summary) {
  if (ErrorSplitTable(summary).rows.empty()) return "";
  const std::string seed = !summary.one_run && summary.blocks.empty() && summary.causes.seeds == 1
                               ? " (first seed)"
                               : "";
  return fmt::format(
      "Shares of the squared error{}: one cause after the other is switched off, and the shares "
      "sum "
      "to 100 %. Two causes share their common effect, so a share is not the effect of one cause "
      "alone.",
      seed);
}

ResultTable SwitchedTable(const Summary& summary) {
  ResultTable table{.columns = {ForPeople("deg RMS without"), ForPeople("nothing")}};
  for (const CauseMetric& error : SwitchedErrors()) {
    table.columns.push_back(CauseColumn(error.name));
  }
  for (const auto& [c, name] : ControllerRows(summary)) {
    const std::vector<MeanInterval>& values = summary.controllers[c].summary;
    if (!std::isfinite(values[ErrorWithAll()].mean)) continue;
    ResultRow& row = table.rows.emplace_back(ResultRow{name});
    const auto add = [&](std::size_t metric) {
      const MeanInterval& value = values[metric];
      row.push_back(
          ResultCell::Text(std::isfinite(value.mean) ? fmt::format("{:.2f}", value.mean) : "-"));
    };
    add(ErrorWithAll());
    for (const CauseMetric& error : SwitchedErrors()) add(error.metric);
  }
  return table;
}

std::string CausesText(const Summary& summary) {
  constexpr double kWorthSaying = 0.02;  // of the error
  const auto value = [&](std::size_t controller, std::size_t metric) -> const MeanInterval& {
    return summary.controllers[controller].summary[metric];
  };
  std::vector<std::size_t> candidates = summary.answer.order;
  if (summary.baseline) candidates.insert(candidates.begin(), *summary.baseline);
  const auto found = std::ranges::find_if(candidates, [&](std::size_t controller) {
    return std::isfinite(value(controller, ErrorWithAll()).mean);
  });
  if (found == candidates.end()) {
    if (!summary.causes.is_left_out && !summary.causes.ticks) return "";
    return fmt::format(
        "Causes of the error: option --causes first computes them, in about {:.2g} times the time.",
        summary.causes.cost_of_first);
  }
  const double all_deg = value(*found, ErrorWithAll()).mean;
  std::vector<CauseMetric> errors(SwitchedErrors().begin(), SwitchedErrors().end());
  std::erase_if(errors, [&](const CauseMetric& error) {
    return !(std::abs(value(*found, error.metric).mean - all_deg) >= kWorthSaying * all_deg);
  });
  std::ranges::stable_sort(
      errors, {}, [&](const CauseMetric& error) { return value(*found, error.metric).mean; });
  std::string text;
  for (const CauseMetric& error : errors) {
    const MeanInterval own = value(*found, error.metric);
    const MeanInterval without = ShownInterval(own, own.mean);
    text += fmt::format("{}without {}: {:.2f}", text.empty() ? "" : "; ", error.name, without.mean);
    if (std::isfinite(without.low)) text += fmt::format(" ±{:.2f}", without.high - without.mean);
    if (&error == &errors.front()) text += fmt::format(" deg in place of {:.2f}", all_deg);
  }
  const std::string& name = summary.controllers[*found].name;
  const std::string part = PartOfCauses(summary);
  const std::string of = part.empty() ? "" : fmt::format(" ({})", part);
  if (errors.empty()) return fmt::format("No cause alone changes the error of {}{}.", name, of);
  return fmt::format("Tracking error of {} {}{}.", name, text, of);
}

}  // namespace gauntlet::sim
