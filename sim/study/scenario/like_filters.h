#pragma once

#include <memory>
#include <string>
#include <vector>

#include "sim/settings/libraries/library.h"
#include "sim/settings/yaml_tree.h"
#include "sim/study/scenario/scenario.h"

namespace gauntlet::sim {

/// A filter whose settings are those of another library:
///
///     filter: {kind: exponential, like: dex-retargeting, low_pass_alpha: 0.2, rate_hz: 30}
struct LikeFilter {
  std::string controller;
  std::size_t index = 0;  // among the controller's filters
  std::string path;       // of its keys in the file
  YamlNode node;
  std::string kind;
  std::string library;
  std::shared_ptr<LikeSettings> settings;
};

/// Reads such filters and takes what they have beyond kind and channels out of the tree.
/// Errors: UserError with the place, as a reader of settings.
std::vector<LikeFilter> TakeLikeFilters(YamlNode& root, const YamlSource& source);

/// Gives them the settings of Gauntlet's filter, at the rate and in the unit of their input.
/// Errors: UserError with the place.
void UseLikeFilters(const std::vector<LikeFilter>& filters, const YamlSource& source,
                    Scenario& scenario);

}  // namespace gauntlet::sim
