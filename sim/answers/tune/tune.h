#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "sim/answers/sweep/sweep_result.h"
#include "sim/answers/tune/tune_split.h"
#include "sim/study/scenario/scenario_reader.h"

namespace gauntlet::sim {

class Elsewhere;
class TuneMemo;

/// The settings to be tuned, and the method.
struct TunePlan {
  ScenarioSource scenario;
  std::string controller;
  std::vector<SweepAxis> free;  // ranges, with whole keys: controllers.<name>.filter.q
  std::size_t minimise = 0;     // in Metrics(); one whose higher values are better is maximised
  std::vector<Constraint> constraints;
  int seeds = 8;     // to search with: the scenario's and those after it
  int held_out = 8;  // for the verdict: those behind. See TuneSplit for recordings
  int evaluations = 100;
  bool physics = true;
  /// False: the least value is the answer, as where kinds of filters are compared.
  bool prefers_low_jitter = true;
  /// Levels of jitter for the front. If there are any, half of the evaluations search around the
  /// best setting, and around the setting with the least delay at each of these levels.
  std::vector<double> front_jitter_deg = {};
  TuneMemo* memo = nullptr;  // of settings that were measured before, and gets others; null: none
  /// Computes the seeds of each setting but the first, see RunTrialsOfSetting(); null: nothing.
  /// Blocks of recordings, which are parts of one trial, are not sent.
  Elsewhere* elsewhere = nullptr;
};

/// `filter.q=1e-6:10:log`, as a range of the controller; `:whole` for whole numbers, alone or after
/// `:log`. Errors: UserError of `--free`.
SweepAxis ParseFree(const std::string& text, const std::string& controller);

/// One setting over some replicates.
struct TunedSetting {
  std::vector<std::string> values = {};   // of what is free
  std::vector<MeanInterval> scores = {};  // of TuneResult::metrics, 95 %
  std::vector<double> minimised = {};     // replicate by replicate: of seeds or blocks
  std::vector<int> motions = {};          // of these
  Met met = Met::kYes;
  std::string problem = {};  // why it could not be built, or the first failure

  bool KeepsBounds() const { return problem.empty() && (met == Met::kYes || met == Met::kLikely); }
};

/// From where to where a free setting is as good as the one that was found.
struct EqualRange {
  std::string low;
  std::string high;
};

struct TuneResult {
  TuneSplit split;                   // fitted and held-out replicates
  std::vector<std::size_t> metrics;  // in Metrics(), the minimised one first
  std::vector<TunedSetting> tried;   // in the order of the search
  std::size_t chosen = 0;            // of `tried`
  TunedSetting verdict;              // of the chosen one, on the held-out part
  TunedSetting before;               // the controller as the scenario has it, on the same
  Comparison gain;                   // verdict against before, one of refused + 1 questions
  std::vector<EqualRange> equal;     // per free setting: among what was tried
  /// Places in `tried`: the Pareto front of delay and jitter among settings that keep the bounds of
  /// other scores.
  std::vector<std::size_t> front;
  int refused = 0;             // better ones that broke a bound on the held-out part
  NamedController controller;  // with the chosen values
  double unit_per_rad = 1.0;   // of the input of its filter: counts, or 1 for angles
  /// The setting of `tried` that breaks the bounds least, if none keeps them.
  std::optional<std::size_t> nearest = {};
  /// Why there is no answer: then all of the above are empty but split, metrics, tried, front,
  /// refused and nearest.
  std::string problem = {};
};

/// `q=0.012, states=3`: the values of what is free, without the keys of the controller.
std::string SettingsText(const TunePlan& plan, const std::vector<std::string>& values);

/// How far a setting breaks the bounds of the plan, in parts of these; infinite without scores.
double ViolationOf(const TunePlan& plan, const TuneResult& result, const TunedSetting& setting);

/// "jitter_rms_deg 0.24 (0.22 to 0.26)": the scores that have bounds.
std::string BoundScoresText(const TunePlan& plan, const TuneResult& result,
                            const TunedSetting& setting);

/// Same as Tune() with a split that is known. If no setting keeps the bounds, the result says so.
TuneResult SearchSettings(const TunePlan& plan, const TuneSplit& split, int jobs,
                          const std::function<bool(double done, double all)>& progress);

/// Searches with Minimise() on the fitted part of SplitOf(), each setting with all of it, and
/// judges on the held-out part. The answer keeps all bounds by its mean on the first, and on the
/// second does not break one by more than its 95 % interval: of the ten best settings the first
/// that does. So many settings are then judged at once. For a primary score, the best are those
/// equivalent to the least value, in the order of jitter, then delay (`prefers_low_jitter`). The
/// same on any number of threads. Errors: UserError, SettingError; RunError if no setting keeps the
/// bounds.
TuneResult Tune(const TunePlan& plan, int jobs,
                const std::function<bool(double done, double all)>& progress);

}  // namespace gauntlet::sim
