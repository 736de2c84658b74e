#pragma once

#include <string>
#include <vector>

#include "sim/settings/libraries/like_filter.h"
#include "sim/settings/yaml_tree.h"
#include "sim/study/scenario/scenario.h"

namespace gauntlet::sim {

/// One of a scenario.
struct LikeFilterOf {
  std::string controller;
  std::size_t index = 0;  // among the controller's filters
  LikeFilter filter;
};

/// Those of all controllers, taken out of the tree. Errors: as ExtractLikeFilter().
std::vector<LikeFilterOf> ExtractLikeFilters(YamlNode& root, const YamlSource& source);

/// Gives them the settings of Gauntlet's filter, at the rate and in the unit of their input.
/// Errors: UserError with the place.
void UseLikeFilters(const std::vector<LikeFilterOf>& filters, const YamlSource& source,
                    Scenario& scenario);

}  // namespace gauntlet::sim
