#include "sim/answers/tune/tune_request.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>

#include "sim/base/error.h"

namespace gauntlet::sim {
namespace {

/// Runs `work`; what it says of a setting is said of this option.
template <class Work>
auto OfOption(const std::string& option, const Work& work) {
  try {
    return work();
  } catch (const controller::SettingError& error) {
    throw UserError({.place = option, .problem = error.problem()});
  }
}

/// Errors: UserError for a score that there is none of without a hand.
void CheckScores(const TunePlan& plan) {
  std::vector<std::size_t> metrics = {plan.minimise};
  for (const Constraint& constraint : plan.constraints) metrics.push_back(constraint.metric);
  for (const std::size_t metric : metrics) {
    if (plan.physics || Metrics()[metric].part == ScoredPart::kJoint) continue;
    throw UserError({.place = "--filter-only",
                     .key = std::string(Metrics()[metric].key),
                     .problem = "is not a score of a joint: there is none without a hand"});
  }
}

/// Which one is tuned: with --all the baseline by default. Errors: UserError.
std::string ControllerOf(const TuneRequest& request, const Scenario& scenario) {
  const std::optional<std::size_t> baseline = BaselineOf(scenario);
  if (request.controller.empty() && request.all && baseline) {
    return scenario.controllers[*baseline].name;
  }
  if (request.controller.empty()) {
    throw UserError({.place = "--controller",
                     .problem = request.all ? "is needed, as the scenario has no baseline"
                                            : "is needed, or --all for all kinds of filters"});
  }
  return FindController(scenario, request.controller).name;
}

/// Errors: UserError where --all and --free are both there, or neither.
void CheckWhatIsFree(const TuneRequest& request) {
  if (request.all && !request.free.empty()) {
    throw UserError({.place = "--free",
                     .problem = "and --all contradict each other: --all has ranges for every kind "
                                "of filter"});
  }
  if (!request.all && request.free.empty()) {
    throw UserError({.place = "--free", .problem = "is needed, or --all for all kinds of filters"});
  }
}

}  // namespace

TunePlan PlanOf(const TuneRequest& request, ScenarioSource scenario) {
  CheckWhatIsFree(request);
  TunePlan plan;
  plan.scenario = std::move(scenario);
  plan.seeds = request.seeds;
  plan.held_out = request.held_out;
  plan.evaluations = request.evaluations;
  plan.physics = !request.filter_only;
  plan.controller = ControllerOf(request, ParseScenario(plan.scenario));
  for (const std::string& text : request.free) {
    plan.free.push_back(ParseFree(text, plan.controller));
    const SweepAxis& axis = plan.free.back();
    if (std::ranges::count(plan.free, axis.key, &SweepAxis::key) > 1) {
      throw UserError({.place = "--free", .key = axis.key, .problem = "is given twice"});
    }
    // A key that there is not, or a range beyond the key's, is found before anything runs.
    for (const double share : {0.5, 0.0, 1.0}) {
      ScenarioSource source = plan.scenario;
      source.overrides.push_back(axis.key + "=" + axis.ValueAt(share));
      ParseScenario(source);
    }
  }
  plan.minimise = OfOption("--minimise", [&] { return FindScore(request.minimise, ""); });
  for (const std::string& text : request.subject_to) {
    plan.constraints.push_back(OfOption("--subject-to", [&] { return ParseConstraint(text, ""); }));
  }
  CheckScores(plan);
  return plan;
}

}  // namespace gauntlet::sim
