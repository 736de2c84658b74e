#pragma once

#include <Eigen/Core>
#include <iterator>
#include <span>
#include <string>

#include "controller/settings.h"

namespace gauntlet::controller {

/// A recording, samples x channels, where it lies: all samples of a channel, then of the next.
///
/// Errors: SettingError for other than as many samples of each of at least one channel.
inline Eigen::Map<const Eigen::MatrixXd> SamplesOfChannels(std::span<const double> values,
                                                           int channel_count) {
  if (channel_count < 1 || std::ssize(values) % channel_count != 0) {
    throw SettingError("recording", "has " + std::to_string(values.size()) + " values for " +
                                        std::to_string(channel_count) +
                                        " channels, must have as many for each");
  }
  return {values.data(), std::ssize(values) / channel_count, channel_count};
}

}  // namespace gauntlet::controller
