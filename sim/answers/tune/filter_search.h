#pragma once

#include <string>
#include <vector>

#include "controller/filters/filter_registry.h"
#include "sim/answers/sweep/sweep_plan.h"

namespace gauntlet::sim {

/// Inputs of the ranges of a filter.
struct FilterInput {
  double rate_hz = 1000.0;    // of its steps
  double unit_per_rad = 1.0;  // of its input: counts, or 1 for angles
};

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
