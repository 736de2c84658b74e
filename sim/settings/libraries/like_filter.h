#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "controller/filters/filter_config.h"
#include "sim/settings/libraries/library.h"
#include "sim/settings/yaml_tree.h"

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
std::optional<LikeFilter> ExtractLikeFilter(YamlNode& filter, std::string path,
                                            const YamlSource& source);

}  // namespace gauntlet::sim
