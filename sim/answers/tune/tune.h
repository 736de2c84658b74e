#pragma once

#include <functional>
#include <string>
#include <vector>

#include "sim/answers/sweep/sweep_result.h"
#include "sim/study/scenario/scenario_reader.h"

namespace gauntlet::sim {

/// The settings to be tuned, and the method.
struct TunePlan {
  ScenarioSource scenario;
  std::string controller;
  std::vector<SweepAxis> free;  // ranges, with whole keys: controllers.<name>.filter.q
  std::size_t minimise = 0;     // in Metrics(); one whose higher values are better is maximised
  std::vector<Constraint> constraints;
  int seeds = 8;     // to search with: the scenario's and those after it
  int held_out = 8;  // for the verdict: those behind
  int evaluations = 100;
  bool physics = true;
  /// False: the least value is the answer, as where kinds of filters are compared.
  bool prefers_low_jitter = true;
  /// Levels of jitter for the front. If there are any, half of the evaluations search around the
  /// best setting, and around the setting with the least delay at each of these levels.
  std::vector<double> front_jitter_deg = {};
};

/// `filter.q=1e-6:10:log`, as a range of the controller; `:whole` for whole numbers, alone or after
/// `:log`. Errors: UserError of `--free`.
SweepAxis ParseFree(const std::string& text, const std::string& controller);

/// One setting over some seeds.
struct TunedSetting {
  std::vector<std::string> values;   // of what is free
  std::vector<MeanInterval> scores;  // of TuneResult::metrics, 95 %
  std::vector<double> minimised;     // seed by seed
  std::vector<int> motions;
  Met met = Met::kYes;
  std::string problem;  // why it could not be built, or the first failure

  bool KeepsBounds() const { return problem.empty() && (met == Met::kYes || met == Met::kLikely); }
};

/// From where to where a free setting is as good as the one that was found.
struct EqualRange {
  std::string low;
  std::string high;
};

struct TuneResult {
  int first_seed = 1;                // of the search; the held-out ones follow behind it
  std::vector<std::size_t> metrics;  // in Metrics(), the minimised one first
  std::vector<TunedSetting> tried;   // in the order of the search
  std::size_t chosen = 0;            // of `tried`
  TunedSetting verdict;              // of the chosen one, on the held-out seeds
  TunedSetting before;               // the controller as the scenario has it, on the same
  CellComparison gain;               // verdict against before
  std::vector<EqualRange> equal;     // per free setting: among what was tried
  /// Places in `tried`: the Pareto front of delay and jitter among settings that keep the bounds of
  /// other scores.
  std::vector<std::size_t> front;
  int refused = 0;             // better ones that broke a bound on the held-out seeds
  NamedController controller;  // with the chosen values
  /// Why there is no answer: then all of the above are empty but metrics, tried, front and refused.
  std::string problem = {};
};

/// The place of a score in `metrics`.
std::size_t PlaceOfMetric(const TuneResult& result, std::size_t metric);

/// `q=0.012, states=3`: the values of what is free, without the keys of the controller.
std::string SettingsText(const TunePlan& plan, const std::vector<std::string>& values);

/// Same as Tune(), but if no setting keeps the bounds, the result says so.
TuneResult SearchSettings(const TunePlan& plan, int jobs,
                          const std::function<bool(double done, double all)>& progress);

/// Searches with Minimise() on `seeds` seeds, each setting with all of them, and judges on others,
/// which the search has not seen. The answer keeps all bounds by its mean on the first, and on the
/// others does not break one by more than its 95 % interval: of the ten best settings the first
/// that does. For a primary score, the best are those equivalent to the least value, in the order
/// of jitter, then delay (`prefers_low_jitter`). The same on any number of threads.
/// Errors: UserError, SettingError; RunError if no setting keeps the bounds.
TuneResult Tune(const TunePlan& plan, int jobs,
                const std::function<bool(double done, double all)>& progress);

}  // namespace gauntlet::sim
