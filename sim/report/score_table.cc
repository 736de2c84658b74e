#include "sim/report/score_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include "sim/report/table_text.h"

namespace gauntlet::sim {
namespace {

constexpr std::string_view kMainMetrics[] = {"tracking_rmse_deg", "aligned_rmse_deg",
                                             "peak_error_deg",    "delay_ms",
                                             "jitter_rms_deg",    "command_reversals_per_s"};

/// The main metrics, and that of the grip where something was held.
std::vector<std::string_view> ShownMetrics(const Summary& summary) {
  std::vector<std::string_view> keys(std::begin(kMainMetrics), std::end(kMainMetrics));
  const std::string_view grip = "grip_force_ripple_n";
  const std::size_t metric = MetricIndex(grip);
  const auto held = [metric](const ControllerSummary& controller) {
    return std::isfinite(controller.summary[metric].mean);
  };
  if (std::ranges::any_of(summary.controllers, held)) keys.push_back(grip);
  return keys;
}

struct Cell {
  std::string text;
  bool best = false;
  bool worse_than_raw = false;
};

Cell MakeCell(const ControllerSummary& controller, std::size_t metric, bool comparison) {
  const MeanInterval& estimate = controller.summary[metric];
  Cell cell{.text = Short(estimate.mean), .best = false, .worse_than_raw = false};
  if (comparison && std::isfinite(estimate.ci95_low)) {
    cell.text += fmt::format(" ±{}", Short(0.5 * (estimate.ci95_high - estimate.ci95_low)));
  }
  cell.worse_than_raw =
      metric < controller.worse_than_raw.size() && controller.worse_than_raw[metric];
  return cell;
}

std::string Decorated(const Cell& cell, std::size_t width, bool colour) {
  const char* mark = cell.worse_than_raw ? "!" : cell.best ? "*" : " ";
  std::string text = Padded(cell.text, width, true) + mark;
  if (!colour) return text;
  if (cell.worse_than_raw) return Warning(text);
  if (cell.best) return Good(text);
  return text;
}

void AppendRows(const Summary& summary, const TableOptions& options, std::string& out) {
  std::size_t name_width = std::string_view("controller").size();
  for (const auto& controller : summary.controllers) {
    name_width = std::max(name_width, controller.name.size());
  }
  std::vector<std::vector<Cell>> columns;
  std::vector<std::size_t> widths;
  const std::vector<std::string_view> keys = ShownMetrics(summary);
  for (const std::string_view key : keys) {
    const std::size_t metric = MetricIndex(key);
    std::vector<Cell>& cells = columns.emplace_back();
    std::size_t width = key.size();
    for (const auto& controller : summary.controllers) {
      cells.push_back(MakeCell(controller, metric, options.comparison));
      cells.back().best = summary.controllers.size() > 1 && controller.as_good_as_best[metric];
      width = std::max(width, Width(cells.back().text));
    }
    widths.push_back(width);
  }
  out += Padded("controller", name_width, false);
  for (std::size_t i = 0; i < columns.size(); ++i) {
    out += "  " + Padded(std::string(keys[i]), widths[i], true) + " ";
  }
  out += "\n";
  for (std::size_t c = 0; c < summary.controllers.size(); ++c) {
    out += Padded(summary.controllers[c].name, name_width, false);
    for (std::size_t i = 0; i < columns.size(); ++i) {
      out += "  " + Decorated(columns[i][c], widths[i], options.colour);
    }
    out += "\n";
  }
}

/// Where a score of the table is a mean over some of the seeds, as the others have none.
void AppendMissingSeeds(const StudyResult& result, const Summary& summary, std::string& out) {
  const int seeds = result.seeds.size();
  for (const ControllerSummary& controller : summary.controllers) {
    for (const std::string_view key : ShownMetrics(summary)) {
      const int count = controller.summary[MetricIndex(key)].count;
      if (count == 0 || count == seeds) continue;
      out += fmt::format("{}: {} from {} of {} seeds; the others have none\n", controller.name, key,
                         count, seeds);
    }
  }
}

}  // namespace

std::span<const std::string_view> MainMetrics() { return kMainMetrics; }

std::string Verdict(const Summary& summary) {
  const std::size_t tracking = MetricIndex("tracking_rmse_deg");
  const std::size_t jitter = MetricIndex("jitter_rms_deg");
  const auto& all = summary.controllers;
  const auto value = [](const ControllerSummary& controller, std::size_t metric) {
    return Short(controller.summary[metric].mean);
  };
  // Of those that follow as well as the best, the one that shakes least.
  const ControllerSummary* follower = nullptr;
  const ControllerSummary* calm = nullptr;
  for (const ControllerSummary& controller : all) {
    if (controller.rank[jitter] == 0) continue;
    const auto calmer = [&](const ControllerSummary* than) {
      return than == nullptr || controller.rank[jitter] < than->rank[jitter];
    };
    if (controller.as_good_as_best[tracking] && calmer(follower)) follower = &controller;
    if (calmer(calm)) calm = &controller;
  }
  if (follower == nullptr) return "";
  if (all.size() == 1) {
    return fmt::format("{} follows within {} deg RMS and shakes by {} deg RMS.", follower->name,
                       value(*follower, tracking), value(*follower, jitter));
  }
  const bool tie = std::count_if(all.begin(), all.end(), [&](const auto& controller) {
                     return controller.as_good_as_best[tracking];
                   }) > 1;
  const char* best = tie ? "follows as well as any" : "follows best";
  std::string text;
  if (follower->as_good_as_best[jitter]) {
    text = fmt::format("{} {} ({} deg RMS) and shakes least ({} deg RMS)", follower->name, best,
                       value(*follower, tracking), value(*follower, jitter));
  } else {
    text = fmt::format("{} {} ({} deg RMS, jitter {}); {} shakes least ({} deg RMS, tracking {})",
                       follower->name, best, value(*follower, tracking), value(*follower, jitter),
                       calm->name, value(*calm, jitter), value(*calm, tracking));
  }
  if (summary.raw >= 0 && follower != &all[summary.raw]) {
    const ControllerSummary& raw = all[summary.raw];
    text += fmt::format("; without a filter: {} and {}", value(raw, tracking), value(raw, jitter));
  }
  return text + ".";
}

std::string ScoreTable(const Study& study, const StudyResult& result, const Summary& summary,
                       const TableOptions& options) {
  std::string out = fmt::format("{}: {}\n", study.scenario.name, study.scenario.question);
  const double seconds = result.first_glove.counts.rows() / result.rate_hz;
  // One seed has neither an interval nor chance.
  const bool several = options.comparison && result.seeds.size() > 1;
  const std::string seeds = several
                                ? fmt::format("seeds {} to {}, mean ± half of the 95 % interval",
                                              result.seeds.front().seed, result.seeds.back().seed)
                                : fmt::format("seed {}", result.seeds.front().seed);
  out += fmt::format("{:.1f} s, {} channels; {}; reference: {}\n\n", seconds,
                     result.channel_names.size(), seeds, result.reference_name);
  AppendRows(summary, options, out);
  out += several ? "* best, or as good within chance" : "* best";
  const bool any_worse = std::any_of(
      summary.controllers.begin(), summary.controllers.end(), [](const ControllerSummary& c) {
        return std::any_of(std::begin(kMainMetrics), std::end(kMainMetrics),
                           [&](std::string_view key) {
                             const std::size_t metric = MetricIndex(key);
                             return metric < c.worse_than_raw.size() && c.worse_than_raw[metric];
                           });
      });
  if (any_worse) out += "   ! worse than raw";
  out += "\n";
  for (const ControllerSummary& controller : summary.controllers) {
    if (!controller.problem.empty()) {
      out += fmt::format("{} stopped early: {}\n", controller.name, controller.problem);
    }
  }
  AppendMissingSeeds(result, summary, out);
  const std::string verdict = Verdict(summary);
  if (!verdict.empty()) out += "\n" + verdict + "\n";
  return out;
}

}  // namespace gauntlet::sim
