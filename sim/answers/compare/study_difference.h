#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "sim/answers/compare/study_folder.h"
#include "sim/base/json.h"
#include "sim/results/result_table.h"
#include "sim/score/statistics/statistics.h"

namespace gauntlet::sim {

/// A setting with another value in B than in A; none where the folder has no such setting.
struct SettingDifference {
  std::string key;
  std::optional<std::string> a;
  std::optional<std::string> b;
};

enum class ScoreChange { kNone, kBetter, kWorse, kOnlyInA, kOnlyInB, kOtherJoints };

/// One score of one controller. It changed if the 95 % interval of B - A does not hold 0, or, where
/// there is no interval, if the values differ at all; never by less than one part in 10^9. Means
/// over other joints are shown and not judged.
struct ScoreDifference {
  std::string controller;
  std::size_t metric;  // of Metrics()
  double a;            // means over the seeds
  double b;
  MeanInterval difference;  // B - A; NaN limits where there is no interval
  ScoreChange change;
};

/// Source of the intervals. Only seeds that both folders have are compared: the same seed is the
/// same glove.
enum class DifferenceMethod {
  kPaired,    // several such seeds: EstimateDifference()
  kUnpaired,  // none: EstimateUnpairedDifference() of all
  kPlain,     // one such seed, or none and A or B has but one: no interval
};

/// Lists of names are those that only one of the two has.
struct StudyDifference {
  std::vector<SettingDifference> settings;  // of what both have; not the versions
  std::vector<SettingDifference> versions;  // of the programs and the hand model
  std::vector<std::string> controllers_only_in_a;
  std::vector<std::string> controllers_only_in_b;
  std::vector<std::string> channels_only_in_a;
  std::vector<std::string> channels_only_in_b;
  std::vector<std::string> metrics_only_in_a;  // the version that wrote the other knew them not
  std::vector<std::string> metrics_only_in_b;
  DifferenceMethod method = DifferenceMethod::kPlain;
  std::vector<int> common_seeds;        // in the order of A
  std::vector<ScoreDifference> scores;  // of the controllers that both have

  std::size_t ChangedScores() const;
  /// Nothing differs; other versions that give the same scores do not count, nor what they do not
  /// know.
  bool Same() const;
};

/// NaN without any.
double MeanOfFinite(const std::vector<double>& values);

/// Seeds that both have, in the order of A.
std::vector<int> CommonSeeds(const std::vector<int>& a, const std::vector<int>& b);
/// The scores of these seeds, in this order; all of them where there are no such seeds.
ScoreFile OfSeeds(const std::vector<int>& seeds, ScoreFile scores);

/// Pure and deterministic.
StudyDifference CompareStudies(const StudyFolder& a, const StudyFolder& b);

/// Size of a difference: a multiple of the smallest relevant difference of its score; infinite if a
/// value is missing in A or B, 0 for kNone.
double SizeOf(const ScoreDifference& score);

/// A row per score that A and B have, or per one that changed; `verbose` adds confidence intervals.
ResultTable ScoreDifferences(const StudyDifference& difference, bool all, bool verbose);

/// The difference as JSON.
Json StudyDifferenceJson(const StudyFolder& a, const StudyFolder& b,
                         const StudyDifference& difference);

/// "better", "worse", ...: what a change means for B.
std::string_view ChangeText(ScoreChange change);

}  // namespace gauntlet::sim
