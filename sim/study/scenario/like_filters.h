#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/settings/libraries/library.h"
#include "sim/settings/yaml_tree.h"
#include "sim/study/scenario/scenario.h"

namespace gauntlet::sim {

/// A filter whose settings are those of another library:
///
///     filter: {kind: exponential, like: dex-retargeting, low_pass_alpha: 0.2, loop_hz: 30}
struct LikeFilter {
  std::string path;  // of its keys in the file; empty: it is the file
  YamlNode node;
  std::shared_ptr<LikeSettings> settings;

  /// Settings of Gauntlet's filter at a rate, for an input in `unit` (deg, rad, counts); empty: in
  /// that of the settings. Errors: UserError with the place, as for counts beside an angle.
  controller::FilterSettings At(double rate_hz, std::string_view unit,
                                const YamlSource& source) const;
};

/// Takes what such a filter has beyond kind and channels out of its node; nothing for a filter of
/// Gauntlet. Errors: UserError with the place, as a reader of settings.
std::optional<LikeFilter> TakeLikeFilter(YamlNode& filter, std::string path,
                                         const YamlSource& source);

/// One of a scenario.
struct LikeFilterOf {
  std::string controller;
  std::size_t index = 0;  // among the controller's filters
  LikeFilter filter;
};

/// Those of all controllers, taken out of the tree. Errors: as TakeLikeFilter().
std::vector<LikeFilterOf> TakeLikeFilters(YamlNode& root, const YamlSource& source);

/// Gives them the settings of Gauntlet's filter, at the rate and in the unit of their input.
/// Errors: UserError with the place.
void UseLikeFilters(const std::vector<LikeFilterOf>& filters, const YamlSource& source,
                    Scenario& scenario);

}  // namespace gauntlet::sim
