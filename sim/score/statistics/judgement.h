#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "controller/number.h"
#include "sim/score/statistics/statistics.h"

namespace gauntlet::sim {

/// The result of comparing two controllers or two settings. Table, page, JSON and the claims of the
/// paper use this scale and no other.
enum class Judgement {
  kNone,  // nothing to judge: no value, one run, a controller and itself
  kBetter,
  kEqual,  // below the smallest relevant difference
  kUndecided,
  kWorse,
};

/// "better", "equal", ...; empty for kNone.
std::string_view JudgementText(Judgement judgement);
/// As sentences have it: "equivalent" for kEqual.
std::string_view JudgementWord(Judgement judgement);

/// One difference, first - second, to be judged: is the first better?
struct Question {
  MeanEstimate difference;
  double relevant_difference = 0.0;  // the smallest that matters, of the same unit
  bool lower_is_better = true;
};

/// Its answer. What is printed is what decides: the judgement follows from this interval alone.
struct Comparison {
  MeanInterval difference;
  double relevant_difference = controller::kNaN;
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

/// The error that all questions of one family together may make.
constexpr double kFamilyError = 0.05;

/// Answers all questions of one family, in their order. Of m that can be answered every interval
/// has the level 1 - 0.05 / m (Bonferroni), so that all of them together hold their truths in 95 %
/// of families, and with them all that is read from them: better, worse and equal, of pairs chosen
/// before or after. Holm's steps would give narrower intervals to what is rejected, which hold
/// together no more, so that "equal" could not be read from them.
/// Source: Dunn 1961, doi 10.1080/01621459.1961.10482090.
std::vector<Comparison> Judge(std::span<const Question> questions);

}  // namespace gauntlet::sim
