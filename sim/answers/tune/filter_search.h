#pragma once

#include <string>
#include <vector>

#include "sim/answers/sweep/sweep_plan.h"
#include "sim/study/scenario/filter_input.h"

namespace gauntlet::sim {

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
