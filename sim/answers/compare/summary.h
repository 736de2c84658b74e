#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sim/answers/compare/recording_blocks.h"
#include "sim/results/verdict.h"
#include "sim/score/priority.h"
#include "sim/score/statistics/judgement.h"
#include "sim/score/statistics/statistics.h"
#include "sim/study/study_run.h"

namespace gauntlet::sim {

/// One controller over all seeds. Vectors of metrics follow Metrics().
struct ControllerSummary {
  std::string name;
  std::vector<MeanInterval> summary;  // of itself, 95 %: nothing is decided by it
  /// Against the baseline. This and the next are empty without a baseline, and for the baseline.
  std::vector<Comparison> to_baseline;
  std::vector<double> effect_size;        // of that difference
  std::vector<bool> has_score;            // that can be compared: also false if a trial failed
  std::vector<std::vector<double>> rows;  // rows of ScoreRows x metrics, means
  int failed_trials = 0;                  // their hands were stopped, and have no scores
  std::string problem;                    // of the first of them; empty if all was well

  /// kNone without a baseline, for it, and without an interval.
  Judgement AgainstBaseline(std::size_t metric) const {
    return metric < to_baseline.size() ? to_baseline[metric].judgement : Judgement::kNone;
  }
};

/// The answer of a comparison: AnswerOf() makes it once, and every output shows it. Numbers are
/// places in Summary::controllers. Marks: Summary::MarkOf().
struct ComparisonAnswer {
  Verdict verdict;
  /// Recommended, alternatives, the others by tracking error.
  std::vector<std::size_t> order;
  /// For a page and a video, at most three: the baseline, the recommended controller and the first
  /// alternative. Where nothing is recommended, or nothing to compare it with is among them, the
  /// next in the order.
  std::vector<std::size_t> shown;
  /// Role of each controller: "recommended", "equivalent", "less jitter", "baseline"; may be empty.
  std::vector<std::string> roles;
};

/// Means and judgements of a comparison. All pairs of controllers in the primary scores are one
/// family of questions, see Judge(), and decide the answer. Those in all other metrics are a
/// second family, which explains it. Every pair has one interval and one judgement, and the best
/// may be chosen from the same data. A controller with a failed trial is in no pair.
struct Summary {
  std::vector<ControllerSummary> controllers;
  std::optional<std::size_t> baseline;  // index of the controller that others are compared with
  /// Fewer than two replicates allow no statement about chance: no interval, no judgement.
  bool one_run = true;
  RecordingBlocks blocks;  // of one recording: these are the replicates. A score without values of
                           // blocks has no interval and no judgement
  int motions = 1;         // different ones of the wearer; several are the replicates
  int pairs = 0;           // that were judged
  int primary_pairs = 0;   // of these in primary scores
  Priority priority = {.metric = PrimaryScores().front().metric, .bounds = {}};  // of the scenario
  CausePlan causes = {};                // of the trials with one cause of the error switched off
  std::vector<std::string> no_value;    // of each metric: why, where the motion is too short
  std::vector<std::string> assumed;     // in column maps of recordings, a sentence each
  std::vector<Comparison> comparisons;  // of all pairs, both ways: see Of()
  ComparisonAnswer answer = {};         // what follows from all this: every output shows it

  /// Difference of a metric, first controller minus second, and its judgement.
  const Comparison& Of(std::size_t metric, std::size_t first, std::size_t second) const {
    return comparisons[Place(metric, first, second)];
  }
  /// "*" better than the baseline, "=" equivalent, "!" worse, "?" undecided, else " ".
  char MarkOf(std::size_t controller, std::size_t metric) const;
  std::size_t Place(std::size_t metric, std::size_t first, std::size_t second) const {
    return (metric * controllers.size() + first) * controllers.size() + second;
  }
};

/// The motion of each seed.
std::vector<int> MotionsOf(const StudyResult& result);

/// Summaries of one metric and controller, one per seed.
std::vector<double> SeedValues(const StudyResult& result, std::size_t controller,
                               std::size_t metric);

/// "first 8 s of the first seed", "first seed": the part of a comparison that causes of the error
/// are found of; empty for all of it.
std::string PartOfCauses(const Summary& summary);

/// Pure and deterministic. `blocks`: of this result, where a single recording was divided.
Summary Summarise(const Study& study, const StudyResult& result, RecordingBlocks blocks = {});

/// One line for each controller of which a trial failed: "raw failed in 1 of 8 trials, and is not
/// ranked: at 1.5 s: diverged (seed 3)".
std::vector<std::string> Failures(const Summary& summary, std::size_t seeds);

/// Tracking of the controllers if the reference is the recording, smoothed at another cut-off. The
/// true cut-off is unknown, and the winner may depend on it.
struct SmoothingRank {
  double smoothing_hz = 0.0;
  std::vector<double> tracking_rmse_deg;  // per controller; NaN of one that was stopped
};

/// A study that has been run, with what is concluded from it.
struct FinishedStudy {
  Study study;
  StudyResult result;
  Summary summary;
  bool comparison = false;            // of several seeds, as asked; else one run
  std::filesystem::path folder = {};  // of its files: paths in them are relative to it
  std::string choices = {};           // options that changed the scenario, see ChoicesText()
  std::vector<SmoothingRank> smoothing = {};  // where the reference is a smoothed recording
};

}  // namespace gauntlet::sim
