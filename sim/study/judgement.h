#pragma once

#include <limits>
#include <span>
#include <string_view>
#include <vector>

#include "sim/study/statistics.h"

namespace gauntlet::sim {

/// What a difference between two controllers, or two settings, is found to be. The only scale of
/// verdicts: table, page, JSON and the paper's claims all have it.
enum class Judgement {
  kNone,  // nothing to judge: no value, one run, a controller and itself
  kBetter,
  kEqual,  // within what matters
  kUndecided,
  kWorse,
};

/// "better", "equal", ...; empty for kNone.
std::string_view JudgementText(Judgement judgement);

/// One difference, first - second, to be judged: is the first better?
struct Question {
  MeanEstimate difference;
  double relevant_difference = 0.0;  // the smallest that matters, of the same unit
  bool lower_is_better = true;
};

/// Its answer. What is printed is what decides: the judgement follows from this interval alone.
struct Comparison {
  MeanInterval difference;
  double relevant_difference = std::numeric_limits<double>::quiet_NaN();
  Judgement judgement = Judgement::kNone;
};

/// [low, high] of how much better the first is, against D, the smallest difference that matters:
///
///     equal      -D < low and high < D
///     better      0 < low and D <= mean
///     worse      high < 0 and mean <= -D
///     undecided  otherwise, and without an interval
Judgement JudgeDifference(const MeanInterval& difference, double relevant_difference,
                          bool lower_is_better);

/// The error that all questions of one comparison together may make.
constexpr double kFamilyError = 0.05;

/// The level of confidence of each question's interval so that all questions together make a false
/// step at most in 5 % of comparisons, by Holm's method: of m probabilities, in ascending order, the
/// i-th is held against 0.05 / (m - i + 1), up to the first that is larger. A question whose
/// hypothesis of no difference falls has the level 1 - 0.05 / (m - i + 1) of its own step, all
/// others have that of the step at which it stopped. So the interval excludes 0 exactly where Holm
/// rejects. A NaN is no question: it does not count, and has the level of the last step.
/// Source: Holm 1979, Scandinavian Journal of Statistics 6, 65.
std::vector<double> HolmLevels(std::span<const double> probabilities);

/// Answers all questions of one family at Holm's levels, in their order.
std::vector<Comparison> Judge(std::span<const Question> questions);

}  // namespace gauntlet::sim
