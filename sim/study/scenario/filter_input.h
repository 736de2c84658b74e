#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "controller/filters/filter_config.h"
#include "sim/study/scenario/scenario.h"

namespace gauntlet::sim {

/// Input of a controller's filter.
struct FilterInput {
  double rate_hz = 1000.0;            // of its steps
  double unit_per_rad = 1.0;          // of its input: counts, or 1 for angles
  double counts_per_rad = 1.0;        // of the glove, the mean of its channels
  double least_counts_per_rad = 1.0;  // of the channel that has the fewest
  double most_counts_per_rad = 1.0;

  /// How many of a unit (deg, rad, counts) are one unit of the input.
  double FactorTo(std::string_view unit) const;
};

/// Channels of the glove, in the order of a filter's.
std::vector<std::string> ChannelsOfFilters(const Scenario& scenario);

/// The input of a controller's filter: of all channels, or of one. Errors: UserError.
FilterInput InputOf(const Scenario& scenario, const controller::ControllerConfig& config,
                    std::optional<int> channel = {});

}  // namespace gauntlet::sim
