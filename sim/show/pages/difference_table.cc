#include "sim/show/pages/difference_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <span>
#include <utility>

#include "sim/score/metrics.h"
#include "sim/score/priority.h"
#include "sim/score/statistics/result_cells.h"

namespace gauntlet::sim {
namespace {

constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max();

std::string SeedsText(std::vector<int> seeds) {
  std::sort(seeds.begin(), seeds.end());
  const int count = seeds.size();
  if (count == 1) return fmt::format("seed {}", seeds[0]);
  if (seeds.back() - seeds.front() == count - 1) {
    return fmt::format("seeds {} to {}", seeds.front(), seeds.back());
  }
  return fmt::format("seeds {}", fmt::join(seeds, ", "));
}

std::string ValueText(const std::optional<std::string>& value) {
  if (!value) return "(none)";
  return value->empty() ? "\"\"" : *value;
}

/// At most `most` settings, then the number of the others.
void AddSettings(const std::string& title, const std::vector<SettingDifference>& settings,
                 std::size_t most, ResultText& text) {
  if (settings.empty()) return;
  AddLine(title, text);
  for (const SettingDifference& setting :
       std::span(settings).first(std::min(most, settings.size()))) {
    AddLine(fmt::format("{}: {} -> {}", setting.key, ValueText(setting.a), ValueText(setting.b)),
            text);
  }
  if (settings.size() > most) {
    AddLine(fmt::format("{} others (--verbose)", settings.size() - most), text);
  }
}

void AddNames(const std::string& title, const std::vector<std::string>& names, ResultText& text) {
  if (!names.empty()) AddLine(fmt::format("{}: {}", title, fmt::join(names, ", ")), text);
}

/// " of the common seeds 1 to 4" where A or B has others besides; these are not compared.
std::string OfCommonSeeds(const StudyFolder& a, const StudyFolder& b,
                          const StudyDifference& difference) {
  const std::size_t common = difference.common_seeds.size();
  if (common == 0 || common == std::max(a.scores.seeds.size(), b.scores.seeds.size())) return "";
  return fmt::format(" of the common {}", SeedsText(difference.common_seeds));
}

std::string MethodText(const StudyDifference& difference) {
  switch (difference.method) {
    case DifferenceMethod::kPaired:
      return "paired by seed, 95 % CI of B - A";
    case DifferenceMethod::kUnpaired:
      return "no common seed, so unpaired, 95 % CI of B - A";
    case DifferenceMethod::kPlain:
      return difference.common_seeds.empty()
                 ? "no common seed, and one seed has no interval: every difference counts, also by "
                   "chance"
                 : "one seed has no interval: every difference counts";
  }
  return "";
}

/// "delay of mean_20 41 -> 62 ms (worse)"
std::string ChangeSentence(const ScoreDifference& score) {
  const auto value = [&](double number) {
    return std::isfinite(number) ? Short(number) : std::string("none");
  };
  const std::string unit(Metrics()[score.metric].unit);
  return fmt::format("{} of {} {} -> {}{} ({})", ScoreName(score.metric), score.controller,
                     value(score.a), value(score.b), unit.empty() ? "" : " " + unit,
                     ChangeText(score.change));
}

/// Relevant differences of primary scores before all others, then the larger.
std::pair<bool, double> Importance(const ScoreDifference& score) {
  const double size = SizeOf(score);
  return {IsPrimary(score.metric) && size >= 1.0, size};
}

/// The answer; `largest` begins with the largest differences.
std::string AnswerOf(const StudyDifference& difference, const std::vector<ScoreDifference>& largest,
                     const std::string& of_seeds) {
  const std::size_t names =
      difference.controllers_only_in_a.size() + difference.controllers_only_in_b.size() +
      difference.channels_only_in_a.size() + difference.channels_only_in_b.size();
  const std::string scores = Counted(std::ssize(difference.scores), "score") + of_seeds;
  if (difference.Same()) {
    return fmt::format("Same: equal settings, and {} without a difference{}.", scores,
                       difference.method == DifferenceMethod::kPlain ? "" : " beyond chance");
  }
  const std::size_t changed = difference.ChangedScores();
  std::string text =
      fmt::format("Different: {} and {} of {}", Counted(std::ssize(difference.settings), "setting"),
                  changed, scores);
  if (names > 0) text += fmt::format("; {} in one of them only", names);
  if (changed == 0) return text + ".";
  constexpr std::size_t kMost = 3;
  std::vector<std::string> sentences;
  for (const ScoreDifference& score : std::span(largest).first(std::min(changed, kMost))) {
    sentences.push_back(ChangeSentence(score));
  }
  text +=
      fmt::format(". {}: {}.", changed > kMost ? "Largest" : "Changed", fmt::join(sentences, "; "));
  if (SizeOf(largest.front()) < 1.0) {
    text += " All changes of scores are below the smallest relevant difference.";
  }
  if (difference.method != DifferenceMethod::kPlain) {
    text += " By chance alone about 1 score in 20 changes.";
  }
  return text;
}

}  // namespace

std::vector<ScoreDifference> LargestFirst(const StudyDifference& difference) {
  std::vector<ScoreDifference> scores = difference.scores;
  std::ranges::stable_sort(scores, std::ranges::greater(), Importance);
  return scores;
}

std::string DifferenceAnswer(const StudyFolder& a, const StudyFolder& b,
                             const StudyDifference& difference) {
  return AnswerOf(difference, LargestFirst(difference), OfCommonSeeds(a, b, difference));
}

ResultText DifferenceText(const StudyFolder& a, const StudyFolder& b,
                          const StudyDifference& difference, const DifferenceDetail& detail) {
  const std::string of_seeds = OfCommonSeeds(a, b, difference);
  StudyDifference shown = difference;
  shown.scores = LargestFirst(difference);
  ResultText text = {DifferenceAnswer(a, b, difference)};
  const bool is_short = !detail.verbose && !detail.all;
  AddSettings("Settings, A -> B:", difference.settings, detail.verbose ? kAll : 4, text);
  if (detail.verbose) AddSettings("Versions, A -> B:", difference.versions, kAll, text);
  AddNames("Controllers only in A", difference.controllers_only_in_a, text);
  AddNames("Controllers only in B", difference.controllers_only_in_b, text);
  AddNames("Channels only in A", difference.channels_only_in_a, text);
  AddNames("Channels only in B", difference.channels_only_in_b, text);
  AddNames("Scores only in A", difference.metrics_only_in_a, text);
  AddNames("Scores only in B", difference.metrics_only_in_b, text);
  constexpr std::size_t kFewRows = 6;
  const std::size_t changed = difference.ChangedScores();
  const bool is_cut = is_short && changed > kFewRows;
  if (is_cut) shown.scores.resize(kFewRows);
  ResultTable scores = ScoreDifferences(shown, detail.all, detail.verbose);
  if (!scores.rows.empty()) {
    text.emplace_back(std::move(scores));
    if (is_cut)
      AddLine(fmt::format("{} other scores changed (--verbose).", changed - kFewRows), text);
    if (detail.verbose || difference.method == DifferenceMethod::kPlain) {
      AddLine(fmt::format("Scores{}: {}.", of_seeds, MethodText(difference)), text);
    }
  }
  text.emplace_back("");
  for (const auto& [letter, folder] : {std::pair("A", &a), std::pair("B", &b)}) {
    AddLine(
        fmt::format("{}: {}, {}, {}, Gauntlet {}", letter, folder->name, folder->scenario.name,
                    SeedsText(folder->scores.seeds), folder->scenario.made_with.gauntlet_version),
        text);
  }
  return text;
}

}  // namespace gauntlet::sim
