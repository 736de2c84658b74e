#pragma once

#include <Eigen/Core>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include "controller/settings.h"

namespace gauntlet::controller {

/// One value per channel from a setting that holds one for all, or one for each.
///
/// Errors: SettingError if there are neither 1 nor `channel_count` values.
inline Eigen::ArrayXd PerChannel(std::string_view key, const std::vector<double>& values,
                                 int channel_count) {
  if (values.size() == 1) return Eigen::ArrayXd::Constant(channel_count, values.front());
  if (std::ssize(values) == channel_count) {
    return Eigen::Map<const Eigen::ArrayXd>(values.data(), channel_count);
  }
  const std::string count = std::to_string(channel_count);
  throw SettingError(std::string(key), "has " + std::to_string(values.size()) +
                                           " values, must have 1 for all channels" +
                                           (channel_count > 1 ? " or " + count + ", one for each"
                                                              : ", because there is one channel"));
}

}  // namespace gauntlet::controller
