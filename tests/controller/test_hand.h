#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "controller/controller_config.h"

namespace gauntlet::controller {

/// A glove whose channels go from 200 counts at 0 rad to 800 counts at 1.5 rad.
inline GloveCalibration PlainGlove(int channels) {
  const auto n = static_cast<std::size_t>(channels);
  std::vector<std::string> names;
  for (int i = 0; i < channels; ++i) names.push_back("joint_" + std::to_string(i));
  return {.channel_names = names,
          .low_counts = std::vector<double>(n, 200.0),
          .high_counts = std::vector<double>(n, 800.0),
          .low_angle_rad = std::vector<double>(n, 0.0),
          .high_angle_rad = std::vector<double>(n, 1.5)};
}

/// A hand in which each cable also crosses the joint before its own: C has 1 on the diagonal and
/// 0.4 below it. 0 to 1.5 rad, 100 counts per rad around 512.
inline TendonTransmission CoupledHand(int channels) {
  const auto n = static_cast<std::size_t>(channels);
  TendonTransmission hand;
  hand.coupling.assign(n * n, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    hand.joint_names.push_back("joint_" + std::to_string(i));
    hand.motor_names.push_back("motor_" + std::to_string(i));
    hand.coupling[i * n + i] = 1.0;
    if (i > 0) hand.coupling[i * n + i - 1] = 0.4;
  }
  hand.reference_angle_rad.assign(n, 0.0);
  hand.joint_min_rad.assign(n, 0.0);
  hand.joint_max_rad.assign(n, 1.5);
  hand.counts_per_rad.assign(n, 100.0);
  hand.center_counts.assign(n, 512);
  hand.min_counts.assign(n, 0);
  hand.max_counts.assign(n, 1023);
  return hand;
}

/// The motors of CoupledHand() with all joints at 0.75 rad, which PlainGlove() gives 500 counts.
inline std::vector<std::int32_t> HalfClosed(int channels) {
  std::vector<std::int32_t> counts(static_cast<std::size_t>(channels), 617);
  counts[0] = 587;
  return counts;
}

}  // namespace gauntlet::controller
