#include "sim/report/difference_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "sim/statistics/result_cells.h"

namespace gauntlet::sim {
namespace {

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

void AddSettings(const std::string& title, const std::vector<SettingDifference>& settings,
                 ResultText& text) {
  if (settings.empty()) return;
  text.emplace_back(title);
  for (const SettingDifference& setting : settings) {
    AddLine(fmt::format("{}: {} -> {}", setting.key, ValueText(setting.a), ValueText(setting.b)),
            text);
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
      return "paired by seed, with the 95 % interval of B - A";
    case DifferenceMethod::kUnpaired:
      return "no seed in common, so unpaired, with the 95 % interval of B - A";
    case DifferenceMethod::kPlain:
      return difference.common_seeds.empty()
                 ? "no seed in common and one seed has no interval, so every difference counts, "
                   "also "
                   "by chance"
                 : "one seed has no interval, so every difference counts";
  }
  return "";
}

std::string Count(std::size_t count, const std::string& what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

std::string VerdictOf(const StudyDifference& difference, const std::string& of_seeds) {
  const std::size_t names =
      difference.controllers_only_in_a.size() + difference.controllers_only_in_b.size() +
      difference.channels_only_in_a.size() + difference.channels_only_in_b.size();
  const std::size_t changed = difference.ChangedScores();
  if (difference.Same()) {
    return fmt::format("A and B have the same settings, and {}{} without a difference{}.",
                       Count(difference.scores.size(), "score"), of_seeds,
                       difference.method == DifferenceMethod::kPlain ? "" : " beyond chance");
  }
  std::string text = fmt::format("A and B differ in {} and in {} of {}{}",
                                 Count(difference.settings.size(), "setting"), changed,
                                 Count(difference.scores.size(), "score"), of_seeds);
  if (names > 0) text += fmt::format("; {} in one of them only", names);
  if (changed > 0 && difference.method != DifferenceMethod::kPlain) {
    text += "; by chance alone about 1 score in 20 leaves its interval";
  }
  return text + ".";
}

}  // namespace

ResultText DifferenceText(const StudyFolder& a, const StudyFolder& b,
                          const StudyDifference& difference, bool all) {
  ResultText text;
  for (const auto& [letter, folder] : {std::pair("A", &a), std::pair("B", &b)}) {
    AddLine(
        fmt::format("{}: {}, {}, {}, Gauntlet {}", letter, folder->name, folder->scenario.name,
                    SeedsText(folder->scores.seeds), folder->scenario.made_with.gauntlet_version),
        text);
  }
  AddSettings("settings, A -> B:", difference.settings, text);
  AddSettings("versions, A -> B:", difference.versions, text);
  text.emplace_back("");
  AddNames("controllers only in A", difference.controllers_only_in_a, text);
  AddNames("controllers only in B", difference.controllers_only_in_b, text);
  AddNames("channels only in A", difference.channels_only_in_a, text);
  AddNames("channels only in B", difference.channels_only_in_b, text);
  AddNames("scores that only A knows", difference.metrics_only_in_a, text);
  AddNames("scores that only B knows", difference.metrics_only_in_b, text);
  const std::string of_seeds = OfCommonSeeds(a, b, difference);
  ResultTable scores = ScoreDifferences(difference, all);
  if (!scores.rows.empty()) {
    text.emplace_back(fmt::format("scores{}, {}:", of_seeds, MethodText(difference)));
    text.emplace_back(std::move(scores));
  }
  text.emplace_back(VerdictOf(difference, of_seeds));
  return text;
}

}  // namespace gauntlet::sim
