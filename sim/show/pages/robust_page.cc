#include "sim/show/pages/robust_page.h"

#include <fmt/format.h>

#include "sim/answers/robust/robust_tables.h"
#include "sim/answers/sweep/sweep_tables.h"
#include "sim/show/pages/cells_page.h"
#include "sim/show/pages/interval_chart.h"

namespace gauntlet::sim {

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
  return CellsPage(gathered,
                   {.kind = "Does the verdict hold?",
                    .title = plan.sweep.file.name,
                    .question = plan.sweep.file.question,
                    .facts = HandsText(plan),
                    .verdict = VerdictOf(plan, result).Text(),
                    .text = RobustText(plan, result, true),
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
