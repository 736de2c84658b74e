#include <fmt/format.h>

#include "sim/answers/sweep/response.h"
#include "sim/answers/sweep/sweep_result.h"
#include "sim/answers/sweep/sweep_tables.h"
#include "sim/results/html_text.h"
#include "sim/score/statistics/result_cells.h"
#include "sim/show/pages/cells_page.h"
#include "sim/show/pages/interval_chart.h"
#include "sim/show/pages/pages.h"
#include "sim/study/scenario/scenario_reader.h"

namespace gauntlet::sim {
namespace {

std::string ResponseSection(const SweepPlan& plan, const Response& response) {
  if (response.values.empty()) return "";
  std::string drawings;
  for (std::size_t m = 0; m < response.metrics.size(); ++m) {
    drawings += fmt::format(
        "<figure class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"{}\">{}</figure>\n",
        Metrics()[response.metrics[m]].key, ResponseSvg(response, m, ShortKey(plan, 0)));
  }
  return PageSection("response", fmt::format("Along {}", EscapeHtml(ShortKey(plan, 0))),
                     fmt::format("Means over the seeds with their 95 % intervals. {}",
                                 EscapeHtml(ResponseText(plan, response))),
                     fmt::format("<div class=\"responses\">{}</div>\n", drawings));
}

}  // namespace

std::string SweepPage(const SweepPlan& plan, SweepDatabase& database, const CellRange& cells,
                      const SweepSummary& summary, const Response& response) {
  std::vector<ChartAxis> axes;
  for (std::size_t a = 0; a < plan.file.axes.size(); ++a) {
    axes.push_back(ChartAxisOf(plan.file.axes[a], ShortKey(plan, a),
                               plan.file.design == SweepFile::Design::kGrid));
  }
  Scenario scenario = ParseScenario(plan.scenario);
  KeepControllers(plan.file.controllers, scenario);
  const bool several = scenario.controllers.size() > 1 || axes.size() < 2;
  if (several) {
    ChartAxis& axis = axes.emplace_back();
    axis.name = "controller";
    for (const NamedController& named : scenario.controllers) axis.labels.push_back(named.name);
  }
  CellPoints gathered(std::move(axes), plan.metrics, plan.best_by, summary.results);
  const std::string scenario_name = NameHere(plan.file.scenario);
  ForEachCell(plan, database, cells, [&](const CellResult& result) {
    if (!result.problem.empty()) return;
    CellPoint point{.name = fmt::format("setting {}, {}", result.number, result.controller),
                    .values = result.values,
                    .scores = MeansOf(result.scores),
                    .keeps_bounds = result.CanBeBest(),
                    .yaml = {},
                    .command = {}};
    if (several) point.values.push_back(result.controller);
    gathered.Add(std::move(point), [&](CellPoint& kept) {
      kept.yaml = SettingsYaml(plan.OverridesOf(result.number));
      kept.command = RepeatCommand(plan, scenario_name, result.controller, result.number);
    });
  });
  gathered.Finish();
  PageHead head{.kind = "Gauntlet sweep",
                .title = plan.file.name,
                .question = plan.file.question,
                .facts = fmt::format("{} settings · {} · best by {}{}{}", plan.cell_count(),
                                     Counted(plan.file.seeds, "seed"), ScoreName(plan.best_by),
                                     BoundsText(plan.constraints),
                                     plan.file.physics ? "" : " · filters only, no hand")};
  const Verdict verdict = VerdictOf(plan, summary);
  SetAnswer(verdict, head);
  if (!summary.best.empty()) {
    head.numbers = NumbersOf(plan.metrics, summary.best.front().scores,
                             verdict.recommended.empty() ? "best in the mean" : "");
  }
  return CellsPage(gathered, {.head = std::move(head),
                              .text = SweepText(plan, summary, response, false),
                              .details = {BestCells(plan, summary)},
                              .first_sections = ResponseSection(plan, response)});
}

}  // namespace gauntlet::sim
