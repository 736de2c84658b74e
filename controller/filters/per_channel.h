#pragma once

#include "controller/one_for_each.h"

namespace gauntlet::controller {

/// One value per channel from a setting that holds one for all, or one for each.
///
/// Errors: SettingError if there are neither 1 nor `channel_count` values.
inline Eigen::ArrayXd PerChannel(std::string_view key, const std::vector<double>& values,
                                 int channel_count) {
  return OneForEach("channel", channel_count, key, values);
}

}  // namespace gauntlet::controller
