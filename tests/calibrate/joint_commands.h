#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "sim/fit/chain_log.h"
#include "sim/hand/hand_model.h"
#include "tests/controller/test_signal.h"

namespace gauntlet::sim {

/// Commands for joints of the default hand, and nothing that it did: six sines of 0.1 to 1.2 Hz
/// for each joint, in the middle of its range.
inline ChainLog JointCommands(const std::vector<std::string>& joints, double duration_s,
                              std::uint64_t seed) {
  constexpr double kRate_hz = 200.0;
  const auto rows = static_cast<Eigen::Index>(kRate_hz * duration_s);
  const controller::TendonTransmission hand = HandModel(HandConfig()).transmission();
  controller::TestNoise random(seed);
  ChainLog log;
  log.name = "made up";
  log.parts = joints;
  log.rate_hz = kRate_hz;
  log.command_deg = Signal(rows, std::ssize(joints));
  for (Eigen::Index part = 0; part < std::ssize(joints); ++part) {
    const auto joint = std::ranges::find(hand.joint_names, joints[part]);
    const std::size_t i = joint - hand.joint_names.begin();
    log.command_deg.col(part).setConstant(hand.reference_angle_rad[i] * kDegPerRad);
    const double range_deg = (hand.joint_max_rad[i] - hand.joint_min_rad[i]) * kDegPerRad;
    for (int sine = 0; sine < 6; ++sine) {
      const double angular =
          2.0 * std::numbers::pi * 0.1 * std::pow(12.0, (sine + random.Uniform()) / 6.0);
      const double phase = 2.0 * std::numbers::pi * random.Uniform();
      for (Eigen::Index row = 0; row < rows; ++row) {
        log.command_deg(row, part) += 0.07 * range_deg * std::sin(angular * row / kRate_hz + phase);
      }
    }
  }
  log.angle_deg = log.command_deg;
  return log;
}

}  // namespace gauntlet::sim
