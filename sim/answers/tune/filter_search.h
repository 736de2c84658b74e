#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "controller/filters/filter_registry.h"
#include "sim/answers/sweep/sweep_plan.h"
#include "sim/study/scenario/scenario.h"

namespace gauntlet::sim {

/// Inputs of the ranges of a filter.
struct FilterInput {
  double rate_hz = 1000.0;    // of its steps
  double unit_per_rad = 1.0;  // of its input: counts, or 1 for angles
};

/// The input of a controller's filter. Errors: UserError.
FilterInput InputOf(const Scenario& scenario, const controller::ControllerConfig& config);

/// Power of the input's unit in a setting of a filter: -1 for `beta` of one_euro, 2 for a variance.
int PowerOfInput(std::string_view kind, std::string_view key);

/// The settings of one kind of filter that a search varies: those that trade delay for jitter, from
/// no smoothing to about 0.4 s of it. `key` is that of the setting itself.
struct FilterSearch {
  std::vector<SweepAxis> free;
  /// Why there is nothing to search; empty if there is.
  std::string left_out = {};
};

/// A kind of filter without a search does not compile. `filter` has the measurement variance that
/// it would run with, if it has one.
FilterSearch SearchOf(const controller::FilterConfig& filter, const FilterInput& input);

}  // namespace gauntlet::sim
