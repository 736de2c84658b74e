#pragma once

#include <cmath>
#include <string>

#include "controller/settings.h"

namespace gauntlet::controller {

/// Checks of every function that makes a filter: settings in their range, at least one channel, and
/// a valid rate. Errors: SettingError.
template <class Config>
void CheckFilter(const Config& config, int channel_count, double rate_hz) {
  CheckSettings(config);
  if (channel_count < 1) {
    throw SettingError("channels", "is " + std::to_string(channel_count) + ", must be at least 1");
  }
  constexpr double kLeast_hz = 1e-9;
  constexpr double kMost_hz = 1e9;
  if (!(rate_hz >= kLeast_hz && rate_hz <= kMost_hz)) {
    throw SettingError("rate_hz", "is " + NumberText(rate_hz) + ", must be from " +
                                      NumberText(kLeast_hz) + " to " + NumberText(kMost_hz));
  }
}

}  // namespace gauntlet::controller
