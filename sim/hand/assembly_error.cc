#include "sim/hand/assembly_error.h"

#include <algorithm>
#include <string_view>

#include "sim/base/normal_pair.h"
#include "sim/base/signal.h"

namespace gauntlet::sim {
namespace {

/// The error of one part: normal, the same for a seed whatever else is drawn.
double ErrorOf(int seed, std::string_view what, std::size_t part) {
  RandomStream random(static_cast<std::uint64_t>(seed), what, part);
  return BoxMuller(random).first;
}

}  // namespace

std::vector<double> AssembleWithErrors(const AssemblyErrorConfig& config,
                                       const std::vector<HandJoint>& joints,
                                       const std::vector<Follower>& followers,
                                       std::vector<Drive>& drives) {
  std::vector<double> center_rad;
  for (std::size_t joint = 0; joint < joints.size(); ++joint) {
    center_rad.push_back(config.centre_deg * kRadPerDeg *
                         ErrorOf(config.seed, "assembly centre", joint));
  }
  for (std::size_t motor = 0; motor < drives.size(); ++motor) {
    Drive& drive = drives[motor];
    drive.drum_radius_m *=
        1.0 + 0.01 * config.drum_radius_percent * ErrorOf(config.seed, "assembly drum", motor);
    for (const ShaftJoint& turned : drive.shaft.joints) {
      const Leading leading = LeadingOf(turned.qpos, followers);
      const auto joint = std::ranges::find(joints, leading.qpos, &HandJoint::qpos);
      if (joint == joints.end()) continue;
      drive.shaft.zero_error_rad +=
          turned.ratio * leading.slope * center_rad[joint - joints.begin()];
    }
    for (Cable& cable : drive.cables) {
      for (Crossing& crossing : cable.crossings) {
        const std::size_t place = (motor << 16U) + static_cast<std::size_t>(crossing.dof);
        crossing.arm_error_m = 0.01 * config.moment_arm_percent * crossing.moment_arm_m *
                               ErrorOf(config.seed, "assembly arm", place);
        crossing.moment_arm_m += crossing.arm_error_m;
        const Leading leading = LeadingOf(crossing.qpos, followers);
        for (std::size_t joint = 0; joint < joints.size(); ++joint) {
          if (joints[joint].qpos != leading.qpos) continue;
          cable.natural_length_m += crossing.moment_arm_m * leading.slope * center_rad[joint];
        }
      }
    }
  }
  return center_rad;
}

}  // namespace gauntlet::sim
