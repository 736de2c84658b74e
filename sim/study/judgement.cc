#include "sim/study/judgement.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace gauntlet::sim {

std::string_view JudgementText(Judgement judgement) {
  switch (judgement) {
    case Judgement::kNone:
      return "";
    case Judgement::kBetter:
      return "better";
    case Judgement::kEqual:
      return "equal";
    case Judgement::kUndecided:
      return "undecided";
    case Judgement::kWorse:
      return "worse";
  }
  return "";
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

std::vector<double> HolmLevels(std::span<const double> probabilities) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < probabilities.size(); ++i) {
    if (!std::isnan(probabilities[i])) order.push_back(i);
  }
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return probabilities[i]; });
  double level = 1.0 - kFamilyError;
  std::size_t fallen = 0;
  std::vector<double> levels(probabilities.size());
  for (; fallen < order.size(); ++fallen) {
    const double error = kFamilyError / static_cast<double>(order.size() - fallen);
    level = 1.0 - error;
    if (probabilities[order[fallen]] > error) break;
    levels[order[fallen]] = level;
  }
  for (std::size_t i = fallen; i < order.size(); ++i) levels[order[i]] = level;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    if (std::isnan(probabilities[i])) levels[i] = level;
  }
  return levels;
}

std::vector<Comparison> Judge(std::span<const Question> questions) {
  std::vector<double> probabilities;
  for (const Question& question : questions) {
    probabilities.push_back(question.difference.Probability());
  }
  const std::vector<double> levels = HolmLevels(probabilities);
  std::vector<Comparison> comparisons;
  for (std::size_t i = 0; i < questions.size(); ++i) {
    const auto& [difference, relevant_difference, lower_is_better] = questions[i];
    Comparison& comparison = comparisons.emplace_back();
    comparison.difference = difference.IntervalAt(levels[i]);
    comparison.relevant_difference = relevant_difference;
    comparison.judgement =
        JudgeDifference(comparison.difference, relevant_difference, lower_is_better);
  }
  return comparisons;
}

}  // namespace gauntlet::sim
