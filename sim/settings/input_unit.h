#pragma once

#include <string_view>

#include "controller/filters/filter_config.h"

namespace gauntlet::sim {

/// Power of the input's unit in a setting of a filter: -1 for `beta` of one_euro, 2 for a variance.
int PowerOfInput(std::string_view kind, std::string_view key);

/// Filter for the signal in another unit, of which `factor` are one of the input's.
controller::FilterSettings WithInputUnit(const controller::FilterSettings& settings, double factor);

}  // namespace gauntlet::sim
