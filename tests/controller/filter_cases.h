#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "controller/filters/filter_registry.h"

namespace gauntlet::controller {

/// A filter that the property suite runs over.
struct FilterCase {
  std::string name;
  FilterConfig config;
};

/// How tests print it.
inline void PrintTo(const FilterCase& filter_case, std::ostream* stream) {
  *stream << filter_case.name;
}

/// Every kind with its defaults, and settings that take another way through the code.
std::vector<FilterCase> FilterCases();

/// The same filter for one of `channel_count` channels: settings with a value per channel keep only
/// that channel's.
FilterConfig ForOneChannel(FilterConfig config, int channel, int channel_count);

}  // namespace gauntlet::controller
