#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/answers/tune/tune.h"
#include "sim/study/elsewhere.h"

namespace gauntlet::sim {

/// One kind of filter in place of a controller's own, with the settings that were found for it.
struct TunedKind {
  std::string kind;
  std::string left_out;  // why it was not searched; then there is no result
  TunePlan plan;
  TuneResult result;
  /// Against the chosen kind, in the minimised score on the held-out part; "equal" of itself.
  Comparison to_best;

  bool has_answer() const { return left_out.empty() && result.problem.empty(); }
};

/// Search for every kind of filter: SearchSettings() with the settings of SearchOf() and the same
/// number of evaluations, on the same glove and hand and the same split.
/// `plan.controller` keeps all its settings but the filter; `plan.free` and `plan.front_jitter_deg`
/// are not looked at: fronts are searched at 0.7, 0.5, 0.35 and 0.25 times the jitter that the
/// controller has as it is. The kind is chosen on the fitted part, as settings are: of those
/// equivalent to the best the one with the least jitter. It comes first, then the other kinds with
/// an answer by their held-out values. The held-out part compares them with the chosen one, in one
/// family of judgement.h. Errors: as Tune(), but for kinds that have no answer.
std::vector<TunedKind> TuneAll(const TunePlan& plan, int jobs,
                               const std::function<bool(double done, double all)>& progress);

/// Searches some kinds by their numbers, for plan.memo. Errors: as of TuneAll().
void TuneSomeKinds(const TunePlan& plan, const WorkRange& kinds);

/// Waits until others have searched all kinds, and adds their settings to plan.memo. TuneAll() then
/// runs only what did not come. Errors: RunError for a part of another scenario or build;
/// Cancelled.
void AwaitKinds(const TunePlan& plan, Elsewhere& elsewhere,
                const std::function<bool(double done, double all)>& progress);

/// A kind of filter with settings that are not searched: `speed_from: raw`.
struct FilterForm {
  std::string_view kind;
  std::string_view fixed = {};
};

/// The plan for one form in place of the controller's filter, without what is free.
TunePlan PlanOfForm(const TunePlan& plan, const FilterForm& form);

/// The filter that comes closest to a controller's among some others.
struct NearestFilter {
  std::vector<TunedKind> forms;  // as those of TuneAll(): the chosen one first
  TunedSetting own;              // the controller as the scenario has it, on the held-out part
};

/// TuneAll() for some forms in place of the filter of plan.controller, none of them `none`. Its own
/// jitter is the bound: else the best for a signal with little noise is no smoothing at all. Before
/// the search, `expect` gets about how many seconds it takes. Errors: as TuneAll().
NearestFilter TuneNearest(const TunePlan& plan, std::span<const FilterForm> forms, int jobs,
                          const std::function<void(double seconds)>& expect,
                          const std::function<bool(double done, double all)>& progress);

/// The kind with the setting that breaks the bounds least, if none keeps them; null for none.
const TunedKind* NearestKind(const std::vector<TunedKind>& kinds);

}  // namespace gauntlet::sim
