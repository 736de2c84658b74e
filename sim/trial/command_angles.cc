#include "sim/trial/command_angles.h"

#include <cstdint>
#include <span>
#include <vector>

#include "controller/tendon_map.h"

namespace gauntlet::sim {

Signal CommandAngles(const controller::TendonTransmission& transmission,
                     const IntegerSignal& command_counts) {
  controller::TendonMap map(transmission, true);
  const auto channels = static_cast<Eigen::Index>(transmission.channel_names.size());
  Signal angle(command_counts.rows(), channels);
  std::vector<std::int32_t> counts(static_cast<std::size_t>(command_counts.cols()));
  std::vector<double> joints(transmission.channel_names.size());
  for (Eigen::Index k = 0; k < command_counts.rows(); ++k) {
    // A frame is held for many samples: the same counts are the same angles.
    if (k > 0 && command_counts.row(k) == command_counts.row(k - 1)) {
      angle.row(k) = angle.row(k - 1);
      continue;
    }
    for (std::size_t m = 0; m < counts.size(); ++m) {
      counts[m] = command_counts(k, static_cast<Eigen::Index>(m));
    }
    map.ToJointAngles(std::span<const std::int32_t>(counts), joints);
    for (Eigen::Index c = 0; c < channels; ++c) angle(k, c) = joints[static_cast<std::size_t>(c)];
  }
  return angle;
}

}  // namespace gauntlet::sim
