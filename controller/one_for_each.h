#pragma once

#include <Eigen/Core>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include "controller/settings.h"

namespace gauntlet::controller {

/// One value per channel, joint or motor (`what`) from a setting that holds one for all, or one for
/// each.
///
/// Errors: SettingError if there are neither 1 nor `count` values.
inline Eigen::ArrayXd OneForEach(std::string_view what, int count, std::string_view key,
                                 const std::vector<double>& values) {
  if (values.size() == 1) return Eigen::ArrayXd::Constant(count, values.front());
  if (std::ssize(values) == count) return Eigen::Map<const Eigen::ArrayXd>(values.data(), count);
  const std::string name(what);
  throw SettingError(std::string(key),
                     "has " + std::to_string(values.size()) + " values, must have 1 for all " +
                         name + "s" +
                         (count > 1 ? " or " + std::to_string(count) + ", one for each"
                                    : ", because there is one " + name));
}

}  // namespace gauntlet::controller
