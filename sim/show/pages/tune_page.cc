#include "sim/show/pages/tune_page.h"

#include <fmt/format.h>

#include "sim/answers/sweep/sweep_tables.h"
#include "sim/answers/tune/tune_tables.h"
#include "sim/show/pages/cells_page.h"

namespace gauntlet::sim {

std::string TunePage(const TunePlan& plan, const TuneResult& result) {
  std::vector<ChartAxis> axes;
  for (std::size_t a = 0; a < plan.free.size(); ++a) {
    axes.push_back(ChartAxisOf(plan.free[a], KeyInController(plan, a), false));
  }
  CellPoints gathered(std::move(axes), result.metrics, plan.minimise, std::ssize(result.tried));
  const std::string scenario_name = NameHere(plan.scenario.file);
  const Verdict verdict = VerdictOf(plan, result);
  const char* chosen = verdict.recommended.empty() ? ", not recommended" : ", the answer";
  for (std::size_t i = 0; i < result.tried.size(); ++i) {
    const TunedSetting& setting = result.tried[i];
    if (!setting.problem.empty()) continue;
    gathered.Add({.name = fmt::format("try {}{}", i, i == result.chosen ? chosen : ""),
                  .values = setting.values,
                  .scores = MeansOf(setting.scores),
                  .is_answer = i == result.chosen,
                  .keeps_bounds = setting.KeepsBounds(),
                  .yaml = {},
                  .command = {}},
                 [&](CellPoint& kept) {
                   std::vector<std::string> sets;
                   for (std::size_t a = 0; a < plan.free.size(); ++a) {
                     sets.push_back(plan.free[a].key + "=" + setting.values[a]);
                   }
                   kept.yaml = SettingsYaml(sets);
                   sets.insert(sets.begin(), plan.scenario.overrides.begin(),
                               plan.scenario.overrides.end());
                   kept.command = CompareCommand(scenario_name, plan.seeds, plan.controller, sets);
                 });
  }
  gathered.Finish();
  const Metric& metric = Metrics()[plan.minimise];
  return CellsPage(gathered, {.kind = "Gauntlet tune",
                              .title = fmt::format("{} of {}", plan.controller,
                                                   plan.scenario.file.stem().string()),
                              .question = fmt::format("Which values give the {} {}{}?",
                                                      metric.lower_is_better ? "least" : "most",
                                                      metric.key, BoundsText(plan.constraints)),
                              .facts = fmt::format("{} settings tried on {}{}", result.tried.size(),
                                                   SplitText(result.split),
                                                   plan.physics ? "" : " · filters only, no hand"),
                              .verdict = verdict.Text(),
                              .text = TuneText(plan, result, true)});
}

}  // namespace gauntlet::sim
