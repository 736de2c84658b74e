#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sim/answers/sweep/sweep_tables.h"
#include "sim/answers/tune/tune_all.h"
#include "sim/answers/tune/tune_tables.h"
#include "sim/score/statistics/result_cells.h"
#include "sim/show/pages/cells_page.h"
#include "sim/show/pages/front_chart.h"
#include "sim/show/pages/pages.h"

namespace gauntlet::sim {
namespace {

/// The least upper bound that the plan has of a score; NaN for none.
double MostOf(const TunePlan& plan, std::string_view metric) {
  double most = kNaN;
  for (const Constraint& constraint : plan.constraints) {
    if (constraint.metric != MetricIndex(metric) || !constraint.at_most) continue;
    if (!(most < constraint.bound)) most = constraint.bound;
  }
  return most;
}

CellPoint PointOf(const TunedKind& tuned, std::size_t place, const TunedKind& first,
                  const Verdict& verdict) {
  const TunedSetting& setting = tuned.result.tried[place];
  const bool is_chosen = tuned.has_answer() && place == tuned.result.chosen;
  const bool is_answer = is_chosen && &tuned == &first;
  const std::string settings = SettingsText(tuned.plan, setting.values);
  return {.name = fmt::format("{}{}{}{}", tuned.kind, settings.empty() ? "" : ": ", settings,
                              !is_chosen                    ? ""
                              : !is_answer                  ? ", chosen of its kind"
                              : verdict.recommended.empty() ? ", chosen, not recommended"
                                                            : ", the answer"),
          .values = {tuned.kind},
          .scores = MeansOf(setting.scores),
          .is_answer = is_answer,
          .keeps_bounds = setting.KeepsBounds(),
          .yaml = {},
          .command = {}};
}

/// The settings over the scenario: the kind, then its values.
std::vector<std::string> SetsOf(const TunedKind& tuned, const TunedSetting& setting) {
  std::string filter =
      fmt::format("controllers.{}.filter={{kind: {}", tuned.plan.controller, tuned.kind);
  for (std::size_t a = 0; a < setting.values.size(); ++a) {
    const std::string& key = tuned.plan.free[a].key;
    filter += fmt::format(", {}: {}", key.substr(key.rfind('.') + 1), setting.values[a]);
  }
  return {filter + "}"};
}

/// Adds the settings over the scenario to a point, and the command that repeats it.
void AddSettings(const TunePlan& plan, std::vector<std::string> sets, CellPoint& kept) {
  kept.yaml = SettingsYaml(sets);
  sets.insert(sets.begin(), plan.scenario.overrides.begin(), plan.scenario.overrides.end());
  kept.command = CompareCommand(NameHere(plan.scenario.file), plan.seeds, plan.controller, sets);
}

/// The primary scores of the chosen setting on the held-out part, beside those before.
std::vector<HeadNumber> NumbersOf(const TunePlan& plan, const TuneResult& result) {
  if (!result.problem.empty()) return {};
  std::vector<HeadNumber> numbers = NumbersOf(result.metrics, result.verdict.scores);
  if (!result.before.problem.empty()) return numbers;
  for (HeadNumber& number : numbers) {
    for (std::size_t m = 0; m < result.metrics.size(); ++m) {
      const std::size_t metric = result.metrics[m];
      if (ScoreName(metric) != number.name) continue;
      const double before = result.before.scores[m].mean;
      number.note = fmt::format("before {}", ScoreValue(metric, before));
      if (metric != plan.minimise || !std::isfinite(result.gain.difference.low)) continue;
      number = NumberOf(metric, result.gain, result.verdict.scores[m].mean, before, "before");
    }
  }
  return numbers;
}

}  // namespace

std::string TunePage(const TunePlan& plan, const TuneResult& result) {
  std::vector<ChartAxis> axes;
  for (std::size_t a = 0; a < plan.free.size(); ++a) {
    axes.push_back(ChartAxisOf(plan.free[a], KeyInController(plan, a), false));
  }
  CellPoints gathered(std::move(axes), result.metrics, plan.minimise, std::ssize(result.tried));
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
                   AddSettings(plan, std::move(sets), kept);
                 });
  }
  gathered.Finish();
  const Metric& metric = Metrics()[plan.minimise];
  PageHead head{
      .kind = "Gauntlet tune",
      .title = fmt::format("{} of {}", plan.controller, plan.scenario.file.stem().string()),
      .question =
          fmt::format("Which values give the {} {}{}?", metric.lower_is_better ? "least" : "most",
                      ScoreName(plan.minimise), BoundsText(plan.constraints)),
      .facts =
          fmt::format("{} settings tried on {}{}", result.tried.size(), SplitText(result.split),
                      plan.physics ? "" : " · filters only, no hand")};
  SetAnswer(verdict, head);
  head.numbers = NumbersOf(plan, result);
  const ResultText text = TuneText(plan, result, false);
  const ResultText verbose = TuneText(plan, result, true);
  return CellsPage(gathered, {.head = std::move(head),
                              .text = text,
                              .details = {verbose.begin() + std::ssize(text), verbose.end()}});
}

std::string TunePage(const TunePlan& plan, const std::vector<TunedKind>& kinds) {
  ChartAxis axis{.name = "filter"};
  std::int64_t all = 0;
  for (const TunedKind& tuned : kinds) {
    if (!tuned.result.tried.empty()) axis.labels.push_back(tuned.kind);
    all += std::ssize(tuned.result.tried);
  }
  CellPoints points({axis}, kinds.front().result.metrics, plan.minimise, all);
  const Verdict verdict = VerdictOf(plan, kinds);
  std::vector<std::vector<std::int64_t>> numbers;  // of the points, per kind and setting
  for (const TunedKind& tuned : kinds) {
    std::vector<std::int64_t>& of_kind = numbers.emplace_back();
    for (std::size_t i = 0; i < tuned.result.tried.size(); ++i) {
      const TunedSetting& setting = tuned.result.tried[i];
      of_kind.push_back(points.seen());
      if (!setting.problem.empty()) {
        of_kind.back() = -1;
        continue;
      }
      points.Add(PointOf(tuned, i, kinds.front(), verdict),
                 [&](CellPoint& kept) { AddSettings(plan, SetsOf(tuned, setting), kept); });
    }
  }
  points.Finish();
  std::vector<FrontSeries> fronts;
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    const TuneResult& result = kinds[k].result;
    if (result.tried.empty()) continue;
    const auto place_of = [&](std::size_t i) {
      const auto& kept = points.kept();
      const auto found = std::ranges::find(kept, numbers[k][i], &CellPoints::Kept::number);
      const auto score = [&](std::string_view metric) {
        return result.tried[i].scores[PlaceOfMetric(result.metrics, MetricIndex(metric))].mean;
      };
      return FrontSeries::Place{
          .delay_ms = score("delay_ms"),
          .jitter_deg = score("jitter_rms_deg"),
          .point = found == kept.end() ? kNoPoint : static_cast<std::size_t>(found - kept.begin())};
    };
    FrontSeries& series = fronts.emplace_back();
    series.name = kinds[k].kind;
    for (const std::size_t i : result.front) series.front.push_back(place_of(i));
    if (kinds[k].has_answer()) series.answer = place_of(result.chosen);
  }
  const std::string drawing =
      FrontsSvg(fronts, MostOf(plan, "delay_ms"), MostOf(plan, "jitter_rms_deg"));
  const Metric& metric = Metrics()[plan.minimise];
  PageHead head{.kind = "Gauntlet tune",
                .title = "Which filter for " + plan.scenario.file.stem().string() + "?",
                .question = fmt::format("Which kind of filter gives {} the {} {}{}?",
                                        plan.controller, metric.lower_is_better ? "least" : "most",
                                        ScoreName(plan.minimise), BoundsText(plan.constraints)),
                .facts = fmt::format("at most {} settings of each kind on {}{}", plan.evaluations,
                                     SplitText(SplitOfKinds(kinds)),
                                     plan.physics ? "" : " · filters only, no hand")};
  SetAnswer(verdict, head);
  if (kinds.front().has_answer()) {
    head.numbers = NumbersOf(kinds.front().result.metrics, kinds.front().result.verdict.scores,
                             verdict.recommended.empty() ? kinds.front().kind : "");
  }
  return CellsPage(
      points,
      {.head = std::move(head),
       .text = TuneText(plan, kinds, false),
       .details = TextBehindAnswer(TuneText(plan, kinds, true)),
       .first_sections = PageSection(
           "fronts", "Jitter against delay, kind by kind",
           "A line joins the settings of one kind that no other of its kind beats in both means, "
           "on "
           "the fitted part; a ring is the setting chosen of its kind, within the bounds (dotted). "
           "Nearer to "
           "the lower left corner is better. The legend has the chosen kind first.",
           ScrolledDrawing(drawing, "Fronts of all kinds")),
       .heat = false,
       .front = false});
}

}  // namespace gauntlet::sim
