#pragma once

#include <string>
#include <vector>

#include "controller/filters/filter_registry.h"
#include "sim/sweep/sweep_plan.h"

namespace gauntlet::sim {

/// What a filter's ranges follow from.
struct FilterInput {
  double rate_hz = 1000.0;    // of its steps
  double unit_per_rad = 1.0;  // of its input: counts, or 1 for angles
};

/// What a search for the best settings of one kind of filter varies: the settings that decide
/// between delay and jitter, from no smoothing to about 0.4 s of it. `key` is the setting's own.
struct FilterSearch {
  std::vector<SweepAxis> free;
  /// Why there is nothing to search; empty if there is.
  std::string left_out = {};
};

/// A kind of filter without a search does not compile. `filter` has the measurement variance that
/// it would run with, if it has one.
FilterSearch SearchOf(const controller::FilterConfig& filter, const FilterInput& input);

}  // namespace gauntlet::sim
