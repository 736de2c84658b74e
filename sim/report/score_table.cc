#include "sim/report/score_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <vector>

#include "sim/report/error_split_table.h"
#include "sim/report/table_text.h"

namespace gauntlet::sim {
namespace {

/// The main metrics that some controller has a value of.
std::vector<std::size_t> ShownMetrics(const Summary& summary) {
  std::vector<std::size_t> shown;
  for (std::size_t m = 0; m < Metrics().size(); ++m) {
    const auto has_value = [m](const ControllerSummary& controller) {
      return std::isfinite(controller.summary[m].mean);
    };
    if (Metrics()[m].main && std::ranges::any_of(summary.controllers, has_value)) {
      shown.push_back(m);
    }
  }
  return shown;
}

struct Cell {
  std::string text;
  bool best = false;
  bool worse_than_baseline = false;
};

Cell MakeCell(const ControllerSummary& controller, std::size_t metric, bool comparison) {
  const MeanInterval& estimate = controller.summary[metric];
  Cell cell{.text = Short(estimate.mean), .best = false, .worse_than_baseline = false};
  if (comparison && std::isfinite(estimate.ci95_low)) {
    cell.text += fmt::format(" ±{}", Short(0.5 * (estimate.ci95_high - estimate.ci95_low)));
  }
  cell.worse_than_baseline =
      metric < controller.worse_than_baseline.size() && controller.worse_than_baseline[metric];
  return cell;
}

std::string Decorated(const Cell& cell, std::size_t width, bool colour) {
  const char* mark = cell.worse_than_baseline ? "!" : cell.best ? "*" : " ";
  std::string text = Padded(cell.text, width, true) + mark;
  if (!colour) return text;
  if (cell.worse_than_baseline) return Warning(text);
  if (cell.best) return Good(text);
  return text;
}

void AppendRows(const FinishedStudy& finished, bool colour, std::string& out) {
  const Summary& summary = finished.summary;
  std::size_t name_width = std::string_view("controller").size();
  for (const auto& controller : summary.controllers) {
    name_width = std::max(name_width, controller.name.size());
  }
  std::vector<std::vector<Cell>> columns;
  std::vector<std::size_t> widths;
  const std::vector<std::size_t> shown = ShownMetrics(summary);
  for (const std::size_t metric : shown) {
    std::vector<Cell>& cells = columns.emplace_back();
    std::size_t width = Metrics()[metric].key.size();
    for (const auto& controller : summary.controllers) {
      cells.push_back(MakeCell(controller, metric, finished.comparison));
      cells.back().best = summary.controllers.size() > 1 && controller.as_good_as_best[metric];
      width = std::max(width, Width(cells.back().text));
    }
    widths.push_back(width);
  }
  out += Padded("controller", name_width, false);
  for (std::size_t i = 0; i < columns.size(); ++i) {
    out += "  " + Padded(std::string(Metrics()[shown[i]].key), widths[i], true) + " ";
  }
  out += "\n";
  for (std::size_t c = 0; c < summary.controllers.size(); ++c) {
    out += Padded(summary.controllers[c].name, name_width, false);
    for (std::size_t i = 0; i < columns.size(); ++i) {
      out += "  " + Decorated(columns[i][c], widths[i], colour);
    }
    out += "\n";
  }
}

/// Where a score of the table is a mean over some of the seeds, as the others have none.
void AppendMissingSeeds(const StudyResult& result, const Summary& summary, std::string& out) {
  const int seeds = result.seeds.size();
  for (const ControllerSummary& controller : summary.controllers) {
    for (const std::size_t metric : ShownMetrics(summary)) {
      const int count = controller.summary[metric].count;
      if (count == 0 || count == seeds) continue;
      out += fmt::format("{}: {} from {} of {} seeds; the others have none\n", controller.name,
                         Metrics()[metric].key, count, seeds);
    }
  }
}

}  // namespace

namespace {

std::string Value(const ControllerSummary& controller, std::size_t metric) {
  return Short(controller.summary[metric].mean);
}

/// What is asked of one run, without a word about chance.
std::string VerdictOfOneRun(const Summary& summary, std::size_t tracking, std::size_t jitter) {
  const auto best = [&](std::size_t metric) {
    return std::ranges::find_if(summary.controllers,
                                [metric](const auto& c) { return c.rank[metric] == 1; });
  };
  const auto follower = best(tracking);
  const auto calm = best(jitter);
  if (follower == summary.controllers.end() || calm == summary.controllers.end()) return "";
  if (follower == calm) {
    return fmt::format(
        "In this one run {} follows nearest ({} deg RMS) and shakes least ({} deg RMS).",
        follower->name, Value(*follower, tracking), Value(*follower, jitter));
  }
  return fmt::format(
      "In this one run {} follows nearest ({} deg RMS, jitter {}); {} shakes least ({} deg RMS, "
      "tracking {}).",
      follower->name, Value(*follower, tracking), Value(*follower, jitter), calm->name,
      Value(*calm, jitter), Value(*calm, tracking));
}

/// Why there is no interval, star or flag; empty if there are.
std::string ReasonForNoChance(const FinishedStudy& finished) {
  if (!finished.summary.one_run) return "";
  if (finished.result.seeds_alike) {
    return "Every seed gives the same run, as nothing in it is drawn at random: one was run, and "
           "there is no interval, no star and no flag.";
  }
  return "One seed tells nothing about chance: no interval, no star, no flag (gauntlet compare "
         "runs "
         "several).";
}

std::string Legend(const FinishedStudy& finished) {
  const Summary& summary = finished.summary;
  if (summary.one_run) return ReasonForNoChance(finished) + "\n";
  std::string legend = "* best, or as good within chance";
  const bool any_worse = std::ranges::any_of(summary.controllers, [&](const auto& controller) {
    return std::ranges::any_of(ShownMetrics(summary), [&](std::size_t metric) {
      return metric < controller.worse_than_baseline.size() &&
             controller.worse_than_baseline[metric];
    });
  });
  if (any_worse) {
    legend += "   ! worse than " + summary.controllers[*summary.baseline].name;
  }
  return legend + "\n";
}

}  // namespace

std::string Verdict(const Summary& summary) {
  const std::size_t tracking = MetricIndex("tracking_rmse_deg");
  const std::size_t jitter = MetricIndex("jitter_rms_deg");
  const auto& all = summary.controllers;
  if (all.size() == 1) {
    if (all[0].rank[tracking] == 0 || all[0].rank[jitter] == 0) return "";
    return fmt::format("{} follows within {} deg RMS and shakes by {} deg RMS.", all[0].name,
                       Value(all[0], tracking), Value(all[0], jitter));
  }
  if (summary.one_run) return VerdictOfOneRun(summary, tracking, jitter);
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
  if (follower == nullptr || calm == nullptr) return "";
  const bool tie = std::ranges::count_if(all, [&](const auto& controller) {
                     return controller.as_good_as_best[tracking];
                   }) > 1;
  const char* best = tie ? "follows as well as any" : "follows best";
  std::string text;
  if (follower->as_good_as_best[jitter]) {
    text = fmt::format("{} {} ({} deg RMS) and shakes least ({} deg RMS)", follower->name, best,
                       Value(*follower, tracking), Value(*follower, jitter));
  } else {
    text = fmt::format("{} {} ({} deg RMS, jitter {}); {} shakes least ({} deg RMS, tracking {})",
                       follower->name, best, Value(*follower, tracking), Value(*follower, jitter),
                       calm->name, Value(*calm, jitter), Value(*calm, tracking));
  }
  if (summary.baseline && follower != &all[*summary.baseline]) {
    const ControllerSummary& baseline = all[*summary.baseline];
    text += fmt::format("; {}: {} and {}", baseline.name, Value(baseline, tracking),
                        Value(baseline, jitter));
  }
  return text + ".";
}

std::string DurationText(const StudyResult& result) {
  const std::string shortest = fmt::format("{:.1f}", result.shortest_s);
  const std::string longest = fmt::format("{:.1f}", result.longest_s);
  return shortest == longest ? longest + " s" : fmt::format("{} to {} s", shortest, longest);
}

std::string WhatVaries(const StudyResult& result) {
  std::map<int, int> seeds_of;  // motion -> how many seeds
  for (const SeedOutcome& seed : result.seeds) ++seeds_of[seed.motion];
  const std::size_t motions = seeds_of.size();
  const std::string moved = motions == 1 ? "one motion" : fmt::format("{} motions", motions);
  if (result.seeds_alike) return moved + ", nothing drawn at random";
  if (motions == 1) return fmt::format("{}, {} noises", moved, result.seeds.size());
  int fewest = std::ssize(result.seeds);
  int most = 0;
  for (const auto& [motion, seeds] : seeds_of) {
    fewest = std::min(fewest, seeds);
    most = std::max(most, seeds);
  }
  if (most == 1) return moved + ", one noise each";
  if (fewest == most) return fmt::format("{}, {} noises each", moved, most);
  return fmt::format("{}, {} to {} noises each", moved, fewest, most);
}

std::string Measured(const Study& study) {
  return fmt::format("{} of {} joints measured", study.measured_joint_names.size(),
                     study.joint_count);
}

std::string ScoreTable(const FinishedStudy& finished, bool colour) {
  const StudyResult& result = finished.result;
  const Summary& summary = finished.summary;
  const Scenario& scenario = finished.study.scenario;
  std::string out = fmt::format("{}: {}\n", scenario.name, scenario.question);
  const std::string seeds =
      summary.one_run
          ? fmt::format("seed {}", result.seeds.front().seed)
          : fmt::format("seeds {} to {}: {}; mean ± half of the 95 % interval",
                        result.seeds.front().seed, result.seeds.back().seed, WhatVaries(result));
  out += fmt::format("{}, {}; {}; reference: {}\n\n", DurationText(result),
                     Measured(finished.study), seeds, result.reference_name);
  AppendRows(finished, colour, out);
  out += Legend(finished);
  for (const ControllerSummary& controller : summary.controllers) {
    if (!controller.problem.empty()) {
      out += fmt::format("{} stopped early: {}\n", controller.name, controller.problem);
    }
  }
  AppendMissingSeeds(result, summary, out);
  if (const std::string split = ErrorSplitTable(summary); !split.empty()) out += "\n" + split;
  const std::string verdict = Verdict(summary);
  if (!verdict.empty()) out += "\n" + verdict + "\n";
  return out;
}

}  // namespace gauntlet::sim
