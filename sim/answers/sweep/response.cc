#include "sim/answers/sweep/response.h"

#include <algorithm>
#include <map>

#include "controller/number.h"
#include "sim/study/scenario/scenario.h"
#include "sim/study/scenario/scenario_reader.h"

namespace gauntlet::sim {
namespace {

constexpr std::int64_t kMostValues = 100;
constexpr std::size_t kMostControllers = 8;

}  // namespace

Response ReadResponse(const SweepPlan& plan, SweepDatabase& database, const CellRange& cells) {
  if (plan.file.axes.size() != 1 || plan.cell_count() > kMostValues) return {};
  std::map<double, std::vector<CellResult>> by_value;
  bool numbers = true;
  ForEachCell(plan, database, cells, [&](const CellResult& result) {
    const std::optional<double> value = controller::ParseNumber(result.values.front());
    numbers = numbers && value;
    if (numbers && result.problem.empty()) by_value[*value].push_back(result);
  });
  if (!numbers || by_value.size() < 2) return {};

  Response response;
  response.metrics = plan.metrics;
  Scenario scenario = ParseScenario(plan.scenario);
  KeepControllers(plan.file.controllers, scenario);
  if (scenario.controllers.size() > kMostControllers) return {};
  for (const NamedController& named : scenario.controllers)
    response.controllers.push_back(named.name);

  const auto find = [](const std::vector<CellResult>& results, const std::string& controller) {
    return std::ranges::find(results, controller, &CellResult::controller);
  };
  response.comparisons = by_value.size() * (response.controllers.size() - 1);
  for (std::size_t c = 1; c < response.controllers.size(); ++c)
    response.verdicts.push_back({.controller = response.controllers[c], .judgements = {}});
  const std::vector<MeanInterval> nothing(response.metrics.size());
  for (const auto& [value, results] : by_value) {
    response.values.push_back(value);
    response.texts.push_back(results.front().values.front());
    const auto first = find(results, response.controllers.front());
    std::vector<std::vector<MeanInterval>>& scores = response.scores.emplace_back();
    for (std::size_t c = 0; c < response.controllers.size(); ++c) {
      const auto result = find(results, response.controllers[c]);
      scores.push_back(result == results.end() ? nothing : result->scores);
      if (c == 0) continue;
      response.verdicts[c - 1].judgements.push_back(
          result == results.end() || first == results.end()
              ? Judgement::kNone
              : CompareCells(plan, *result, *first, static_cast<double>(response.comparisons))
                    .judgement);
    }
  }
  return response;
}

}  // namespace gauntlet::sim
