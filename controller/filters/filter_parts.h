#pragma once

#include <memory>
#include <vector>

#include "controller/filters/filter.h"

namespace gauntlet::controller {

/// A filter of some channels of a sample.
struct FilterPart {
  std::unique_ptr<Filter> filter;
  std::vector<int> channels;  // of the whole sample, one for each channel of `filter`
};

/// One filter of several parts, which share no channel. A channel of no part passes unchanged.
std::unique_ptr<Filter> JoinParts(std::vector<FilterPart> parts, int channel_count);

}  // namespace gauntlet::controller
