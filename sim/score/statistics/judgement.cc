#include "sim/score/statistics/judgement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace gauntlet::sim {

std::string_view JudgementText(Judgement judgement) {
  constexpr std::array<std::string_view, 5> kTexts = {"", "better", "equal", "undecided", "worse"};
  return kTexts.at(static_cast<std::size_t>(judgement));
}

std::string_view JudgementWord(Judgement judgement) {
  return judgement == Judgement::kEqual ? "equivalent" : JudgementText(judgement);
}

Judgement JudgeDifference(const MeanInterval& difference, double relevant_difference,
                          bool lower_is_better) {
  if (std::isnan(difference.mean)) return Judgement::kNone;
  const double gain = lower_is_better ? -difference.mean : difference.mean;
  const double low = lower_is_better ? -difference.high : difference.low;
  const double high = lower_is_better ? -difference.low : difference.high;
  if (-relevant_difference < low && high < relevant_difference) return Judgement::kEqual;
  if (low > 0.0 && gain >= relevant_difference) return Judgement::kBetter;
  if (high < 0.0 && gain <= -relevant_difference) return Judgement::kWorse;
  return Judgement::kUndecided;
}

std::vector<Comparison> Judge(std::span<const Question> questions) {
  const auto can_be_answered = [](const Question& question) {
    return std::isfinite(question.difference.standard_error);
  };
  const auto count = std::max<std::ptrdiff_t>(1, std::ranges::count_if(questions, can_be_answered));
  const double level = 1.0 - kFamilyError / static_cast<double>(count);
  std::vector<Comparison> comparisons;
  for (const auto& [difference, relevant_difference, lower_is_better] : questions) {
    const MeanInterval interval = difference.IntervalAt(level);
    comparisons.push_back({interval, relevant_difference,
                           JudgeDifference(interval, relevant_difference, lower_is_better)});
  }
  return comparisons;
}

}  // namespace gauntlet::sim
