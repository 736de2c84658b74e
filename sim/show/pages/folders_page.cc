#include "sim/show/pages/folders_page.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "controller/assert.h"
#include "sim/answers/compare/study_difference.h"
#include "sim/results/html_text.h"
#include "sim/results/result_table.h"
#include "sim/score/no_score.h"
#include "sim/score/priority.h"
#include "sim/score/statistics/result_cells.h"
#include "sim/show/pages/cells_page.h"
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
  double sum = 0.0;
  int count = 0;
  for (const double value :
       folder.scores
           .summary[static_cast<std::size_t>(found - folder.scores.controllers.begin())][metric]) {
    if (!std::isfinite(value)) continue;
    sum += value;
    ++count;
  }
  return count == 0 ? kNoScore : sum / count;
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

std::string Counted(std::size_t count, const std::string& what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
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
  for (std::size_t i = 0; i < folders.size(); ++i) {
    names.push_back(folders[i].name);
    facts.push_back(fmt::format("{}: {}, {}", folders[i].name, folders[i].scenario.name,
                                Counted(folders[i].scores.seeds.size(), "seed")));
  }
  const std::string of_seeds = KeepCommonSeeds(folders);
  const std::vector<StudyDifference> differences = DifferencesOf(folders);
  const ResultTable settings = SettingsTable(folders, differences);
  std::string sections;
  for (const PrimaryScore& score : PrimaryScores()) {
    const Metric& metric = Metrics()[score.metric];
    sections += PageSection(
        std::string(metric.key), fmt::format("{}, {}", ScoreHeading(score.metric), metric.unit),
        fmt::format("{} Compared with {}: * better, ! worse (95 % confidence interval).", of_seeds,
                    folders.front().name),
        HtmlOf(ScoresTable(folders, differences, score.metric)));
  }
  std::string verdict =
      fmt::format("{} differ between {}.", Counted(settings.rows.size(), "setting"),
                  Counted(folders.size(), "folder"));
  if (settings.rows.size() == 1) verdict.replace(verdict.find("differ"), 6, "differs");
  for (std::size_t i = 1; i < folders.size(); ++i) {
    verdict += fmt::format(" {}: {} of {} changed against {}.", folders[i].name,
                           differences[i].ChangedScores(),
                           Counted(differences[i].scores.size(), "score"), folders.front().name);
  }
  return PlainPage(
      {.kind = "Gauntlet report",
       .title = fmt::format("{} side by side", Counted(folders.size(), "folder")),
       .question = fmt::format("{}", fmt::join(names, ", ")),
       .verdict = verdict,
       .facts = fmt::format("{}", fmt::join(facts, " · ")),
       .heading = "Settings that differ",
       .table = settings.rows.empty() ? "<p class=\"note\">None.</p>\n" : HtmlOf(settings),
       .sections = sections});
}

}  // namespace gauntlet::sim
