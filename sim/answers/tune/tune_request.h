#pragma once

#include <string>
#include <vector>

#include "sim/answers/tune/tune.h"

namespace gauntlet::sim {

/// Request of a user for a search, in texts; the names are those of the options of `gauntlet tune`.
struct TuneRequest {
  std::string controller;         // empty with `all`: the baseline
  std::vector<std::string> free;  // see ParseFree()
  std::string minimise = "tracking_rmse_deg";
  std::vector<std::string> subject_to;  // see ParseConstraint()
  int seeds = 8;
  int held_out = 8;
  int evaluations = 100;
  bool all = false;  // every kind of filter
  bool filter_only = false;
};

/// The plan of a request, with everything checked that can be wrong before anything runs.
/// Errors: UserError.
TunePlan PlanOf(const TuneRequest& request, ScenarioSource scenario);

}  // namespace gauntlet::sim
