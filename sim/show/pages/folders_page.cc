#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "controller/assert.h"
#include "sim/answers/compare/study_difference.h"
#include "sim/answers/compare/study_folder.h"
#include "sim/results/html_text.h"
#include "sim/results/result_table.h"
#include "sim/score/no_score.h"
#include "sim/score/priority.h"
#include "sim/score/statistics/result_cells.h"
#include "sim/show/figure/palette.h"
#include "sim/show/figure/panel.h"
#include "sim/show/pages/cells_page.h"
#include "sim/show/pages/difference_table.h"
#include "sim/show/pages/pages.h"
#include "sim/show/pages/plain_page.h"

namespace gauntlet::sim {
namespace {

/// Differences of each folder to the first one; nothing for the first.
std::vector<StudyDifference> DifferencesOf(const std::vector<StudyFolder>& folders) {
  std::vector<StudyDifference> differences(1);
  for (std::size_t i = 1; i < folders.size(); ++i) {
    differences.push_back(CompareStudies(folders.front(), folders[i]));
  }
  return differences;
}

/// A column per folder behind the name of a row.
ResultTable EmptyTable(const std::string& name, const std::vector<StudyFolder>& folders) {
  ResultTable table{.columns = {ForPeople(name)}};
  for (const StudyFolder& folder : folders) table.columns.push_back(ForPeople(folder.name));
  return table;
}

/// A row per setting that any folder has with another value than the first.
ResultTable SettingsTable(const std::vector<StudyFolder>& folders,
                          const std::vector<StudyDifference>& differences) {
  std::map<std::string, std::optional<std::string>> of_first;
  for (const StudyDifference& difference : differences) {
    for (const SettingDifference& setting : difference.settings) of_first[setting.key] = setting.a;
  }
  ResultTable table = EmptyTable("setting", folders);
  for (ResultColumn& column : table.columns) column.is_words = true;
  for (const auto& [key, first] : of_first) {
    ResultRow& row = table.rows.emplace_back(ResultRow{ResultCell::Text(key)});
    for (const StudyDifference& difference : differences) {
      const auto own = std::ranges::find(difference.settings, key, &SettingDifference::key);
      row.push_back(
          ResultCell::Text((own == difference.settings.end() ? first : own->b).value_or("none")));
    }
  }
  return table;
}

/// Mean over the seeds that have a score; not a number where none has, or where the folder has no
/// such controller.
double MeanOf(const StudyFolder& folder, const std::string& controller, std::size_t metric) {
  const auto found = std::ranges::find(folder.scores.controllers, controller);
  if (found == folder.scores.controllers.end()) return kNoScore;
  const auto place = static_cast<std::size_t>(found - folder.scores.controllers.begin());
  return MeanOfFinite(folder.scores.summary[place][metric]);
}

char MarkOf(const StudyDifference& difference, const std::string& controller, std::size_t metric) {
  const auto found = std::ranges::find_if(difference.scores, [&](const ScoreDifference& score) {
    return score.controller == controller && score.metric == metric;
  });
  if (found == difference.scores.end()) return ' ';
  if (found->change == ScoreChange::kBetter) return '*';
  return found->change == ScoreChange::kWorse ? '!' : ' ';
}

/// All controllers, in the order of the first folder that has them.
std::vector<std::string> ControllersOf(const std::vector<StudyFolder>& folders) {
  std::vector<std::string> names;
  for (const StudyFolder& folder : folders) {
    for (const std::string& name : folder.scores.controllers) {
      if (std::ranges::count(names, name) == 0) names.push_back(name);
    }
  }
  return names;
}

ResultTable ScoresTable(const std::vector<StudyFolder>& folders,
                        const std::vector<StudyDifference>& differences, std::size_t metric) {
  ResultTable table = EmptyTable("controller", folders);
  // Marks judge the shown means. One seed has no interval.
  const bool same_seeds = std::ranges::all_of(folders, [&](const StudyFolder& folder) {
    return folder.scores.seeds == folders.front().scores.seeds;
  });
  const DifferenceMethod method =
      same_seeds ? DifferenceMethod::kPaired : DifferenceMethod::kUnpaired;
  for (const std::string& controller : ControllersOf(folders)) {
    ResultRow& row = table.rows.emplace_back(ResultRow{ResultCell::Text(controller)});
    for (std::size_t i = 0; i < folders.size(); ++i) {
      row.emplace_back(MeanOf(folders[i], controller, metric));
      if (differences[i].method == method) {
        row.back().mark = MarkOf(differences[i], controller, metric);
      }
    }
  }
  return table;
}

/// A row of each controller, a dot of each folder, joined in their order.
std::string ScoresSvg(const std::vector<StudyFolder>& folders, std::size_t metric) {
  constexpr double kEach = 30.0, kFirst = 10.0, kLeft = 124.0;
  const std::vector<std::string> controllers = ControllersOf(folders);
  Extent range;
  range.Include(0.0);
  for (const std::string& controller : controllers) {
    for (const StudyFolder& folder : folders) range.Include(MeanOf(folder, controller, metric));
  }
  if (!(range.high > range.low)) return "";
  range.high += 0.06 * (range.high - range.low);
  const double bottom = kFirst + kEach * static_cast<double>(controllers.size());
  Figure figure{420.0, bottom + kFigureLayout.bottom, "folders", ScoreName(metric)};
  const FigureBox area = {kLeft, kFirst - 6.0, figure.width_px - 14.0, bottom};
  const Panel panel(
      area, {range, fmt::format("{} [{}]", ScoreName(metric), Metrics()[metric].unit), 5, true},
      {});
  panel.AddAxes(figure);
  for (std::size_t c = 0; c < controllers.size(); ++c) {
    const double y = kFirst + kEach * (static_cast<double>(c) + 0.5);
    figure.Text({kLeft - kFigureLayout.tick_gap, y + kFigureLayout.baseline}, Anchor::kEnd,
                FittedText(controllers[c], kLeft - 2.0 * kFigureLayout.tick_gap), {"name"});
    std::vector<FigurePoint> places;
    for (const StudyFolder& folder : folders) {
      const double mean = MeanOf(folder, controllers[c], metric);
      places.push_back({std::isfinite(mean) ? panel.X(mean) : kNoScore, y});
    }
    figure.Path(places, {.css = "way"});
    for (std::size_t i = 0; i < folders.size(); ++i) {
      if (!std::isfinite(places[i].x)) continue;
      figure.Dot(
          places[i], 5.0,
          InkOfSeries(i, "",
                      fmt::format("{}, {}: {}", controllers[c], folders[i].name,
                                  ScoreValue(metric, MeanOf(folders[i], controllers[c], metric)))));
    }
  }
  return SvgOf(figure);
}

std::string LegendOf(const std::vector<std::string>& names) {
  std::string items;
  for (std::size_t i = 0; i < names.size(); ++i) {
    items += fmt::format(
        "<span class=\"item\"><span class=\"dot\" style=\"--colour: {}\"></span>{}</span> ",
        CssOfSeries(i), EscapeHtml(names[i]));
  }
  return fmt::format("<p class=\"legend\">{}</p>\n", items);
}

/// The three largest changes.
std::vector<HeadNumber> NumbersOf(const StudyDifference& difference, const std::string& a,
                                  const std::string& b) {
  constexpr std::size_t kMost = 3;
  std::vector<HeadNumber> numbers;
  for (const ScoreDifference& score : LargestFirst(difference)) {
    const bool is_better = score.change == ScoreChange::kBetter;
    if (!is_better && score.change != ScoreChange::kWorse) continue;
    HeadNumber number = NumberOf(score.metric,
                                 {.difference = score.difference,
                                  .judgement = is_better ? Judgement::kBetter : Judgement::kWorse},
                                 score.b, score.a, a);
    number.name += " of " + score.controller;
    number.note = b + " " + number.note;
    numbers.push_back(std::move(number));
    if (numbers.size() == kMost) break;
  }
  return numbers;
}

/// Leaves the seeds that all folders have, or all of each where there are none. Returns a sentence
/// on the means.
std::string KeepCommonSeeds(std::vector<StudyFolder>& folders) {
  std::vector<int> common = folders.front().scores.seeds;
  for (const StudyFolder& folder : folders) common = CommonSeeds(common, folder.scores.seeds);
  for (StudyFolder& folder : folders) {
    folder.scores = OfSeeds(common, std::move(folder.scores));
  }
  if (common.empty()) return "Mean over the seeds of each folder: no seed is in all of them.";
  if (common.size() == 1) return "One common seed: no confidence interval, so no marks.";
  return fmt::format("Mean over {} common seeds.", common.size());
}

}  // namespace

std::string FoldersPage(std::vector<StudyFolder> folders) {
  GAUNTLET_ASSERT(folders.size() >= 2);
  std::vector<std::string> names, facts;
  PageHead head{.kind = "Gauntlet report",
                .title = fmt::format("{} side by side", Counted(std::ssize(folders), "folder"))};
  std::string answer;
  for (std::size_t i = 0; i < folders.size(); ++i) {
    names.push_back(folders[i].name);
    facts.push_back(fmt::format("{}: {}, {}", folders[i].name, folders[i].scenario.name,
                                Counted(std::ssize(folders[i].scores.seeds), "seed")));
    if (i == 0) continue;
    const StudyDifference difference = CompareStudies(folders[0], folders[i]);
    if (folders.size() > 2) answer += fmt::format("{}{}: ", i == 1 ? "" : " ", folders[i].name);
    answer += DifferenceAnswer(folders[0], folders[i], difference);
    if (i == 1) head.numbers = NumbersOf(difference, folders[0].name, folders[1].name);
  }
  SetAnswer(answer, head);
  head.question = fmt::format("{}", fmt::join(names, ", "));
  head.facts = fmt::format("{}", fmt::join(facts, " · "));
  const std::string of_seeds = KeepCommonSeeds(folders);
  const std::vector<StudyDifference> differences = DifferencesOf(folders);
  const ResultTable settings = SettingsTable(folders, differences);
  std::string scores;
  for (const PrimaryScore& score : PrimaryScores()) {
    scores += fmt::format("<figure id=\"{}\">\n<h3>{}, {}</h3>\n{}{}</figure>\n",
                          Metrics()[score.metric].key, ScoreName(score.metric),
                          Metrics()[score.metric].unit, ScoresSvg(folders, score.metric),
                          HtmlOf(ScoresTable(folders, differences, score.metric)));
  }
  const std::string section = PageSection(
      "scores", "Scores",
      EscapeHtml(fmt::format("{} Compared with {}: * better, ! worse (95 % confidence interval).",
                             of_seeds, folders.front().name)),
      LegendOf(names) + "<div class=\"thirds\">\n" + scores + "</div>\n");
  return PlainPage(
      {.head = std::move(head),
       .heading = "Settings that differ",
       .table = settings.rows.empty() ? "<p class=\"note\">None.</p>\n" : HtmlOf(settings),
       .sections = section});
}

}  // namespace gauntlet::sim
