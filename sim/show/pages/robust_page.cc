#include <fmt/format.h>

#include <algorithm>

#include "sim/answers/robust/robust.h"
#include "sim/answers/robust/robust_tables.h"
#include "sim/answers/sweep/sweep_tables.h"
#include "sim/score/priority.h"
#include "sim/score/statistics/result_cells.h"
#include "sim/show/pages/cells_page.h"
#include "sim/show/pages/interval_chart.h"
#include "sim/show/pages/pages.h"

namespace gauntlet::sim {
namespace {

/// On how many hands the controller of the verdict is best or equivalent, in the primary scores.
std::vector<HeadNumber> SharesOf(const RobustPlan& plan, const RobustResult& result) {
  const std::string name = JudgedController(plan, result);
  std::vector<HeadNumber> numbers;
  for (const PrimaryScore& primary : PrimaryScores()) {
    const auto score = std::ranges::find(result.scores, primary.metric, &RobustScore::metric);
    if (score == result.scores.end()) continue;
    const auto own = std::ranges::find(score->controllers, name, &RobustController::name);
    if (own == score->controllers.end()) continue;
    numbers.push_back(
        {.name = ScoreName(primary.metric),
         .value = fmt::format("{} of {} hands", own->near_best.hits, own->near_best.count),
         .note =
             fmt::format("{} best or equivalent; 95 % CI {}", name, PercentText(own->near_best))});
  }
  return numbers;
}

}  // namespace

std::string RobustPage(const RobustPlan& plan, SweepDatabase& database,
                       const RobustResult& result) {
  std::vector<ChartAxis> axes;
  for (const RobustParameter& parameter : plan.parameters) {
    const double within = 0.01 * plan.within_percent;
    axes.push_back({.name = parameter.name, .low = 1.0 - within, .high = 1.0 + within});
  }
  ChartAxis& controllers = axes.emplace_back();
  controllers.name = "controller";
  for (const ControllerSummary& controller : result.nominal.controllers) {
    controllers.labels.push_back(controller.name);
  }
  CellPoints gathered(
      std::move(axes), plan.sweep.metrics, plan.sweep.best_by,
      plan.sweep.cell_count() * static_cast<std::int64_t>(result.nominal.controllers.size()));
  ForEachCell(plan.sweep, database, ShardOf(plan.sweep, 1, 1), [&](const CellResult& cell) {
    if (!cell.problem.empty()) return;
    CellPoint point{.name = fmt::format("hand {}, {}", cell.number, cell.controller),
                    .values = {},
                    .scores = MeansOf(cell.scores),
                    .yaml = {},
                    .command = {}};
    for (const double factor : plan.factors[static_cast<std::size_t>(cell.number)]) {
      point.values.push_back(fmt::format("{}", factor));
    }
    point.values.push_back(cell.controller);
    gathered.Add(std::move(point), [&](CellPoint& kept) {
      kept.yaml = SettingsYaml(plan.sweep.OverridesOf(cell.number));
      kept.command = RepeatCommand(plan.sweep, "scenario.resolved.yaml", "", cell.number);
    });
  });
  gathered.Finish();
  std::string tornadoes;
  for (const RobustScore& score : result.scores) {
    if (score.bars.empty()) continue;
    tornadoes += fmt::format(
        "<figure class=\"tornado-figure\">{}</figure>\n",
        TornadoSvg(
            plan, score,
            result.nominal.Of(score.metric, score.two_best[0], score.two_best[1]).difference.mean));
  }
  const ResultText text = RobustText(plan, result, false);
  const ResultText verbose = RobustText(plan, result, true);
  PageHead head{
      .kind = "Gauntlet robust",
      .title = plan.sweep.file.name,
      .question = "Does the verdict hold on other hands?",
      .numbers = SharesOf(plan, result),
      .facts = fmt::format("{} hands · {}", plan.hands, Counted(plan.sweep.file.seeds, "seed"))};
  SetAnswer(VerdictOf(plan, result), head);
  return CellsPage(gathered,
                   {.head = std::move(head),
                    .text = text,
                    .details = {verbose.begin() + std::ssize(text), verbose.end()},
                    .first_sections = PageSection(
                        "tornado", "Sensitivity",
                        "Difference between the two best controllers of the nominal hand, with one "
                        "parameter low (hollow) or high (filled), and 95 % confidence intervals. "
                        "The band is the smallest relevant difference around the nominal hand. A "
                        "word marks a decided effect (simultaneous 95 %).",
                        "<div class=\"tornadoes\">" + tornadoes + "</div>\n"),
                    .command_folder = "the folder of this page",
                    .heat = false});
}

}  // namespace gauntlet::sim
