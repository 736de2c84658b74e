#include "sim/trial/joint_angles.h"

#include <cstdint>
#include <span>
#include <vector>

#include "controller/tendon_map.h"

namespace gauntlet::sim {

namespace {

/// Between two columns: few rows fill no memory, and are not worth the question.
void TrimBeside(const Signal& signal) {
  if (signal.rows() >= kTrimRows) TrimSignals();
}

}  // namespace

Signal JointAngles(const controller::JointMap& joint_map, const Signal& channel_angle_rad) {
  Signal joints(channel_angle_rad.rows(), joint_map.joint_count());
  for (int joint = 0; joint < joint_map.joint_count(); ++joint) {
    auto column = joints.col(joint);
    column.setConstant(joint_map.offset_rad(joint));
    for (const auto& term : joint_map.terms(joint)) {
      column += term.weight * channel_angle_rad.col(term.channel);
    }
    TrimBeside(joints);
  }
  return joints;
}

Signal ReferenceAngles(const controller::JointMap& joint_map, const Signal& true_angle_rad) {
  Signal reference = JointAngles(joint_map, true_angle_rad);
  for (Eigen::Index joint = 0; joint < reference.cols(); ++joint) {
    auto column = reference.col(joint);
    column = column.cast<Stored<double>>().cast<double>().eval();
    TrimBeside(reference);
  }
  return reference;
}

Signal CommandAngles(const controller::TendonTransmission& transmission,
                     const IntegerSignal& command_counts) {
  controller::TendonMap map(transmission, true);
  Signal angle(command_counts.rows(), map.joint_count());
  std::vector<std::int32_t> counts(static_cast<std::size_t>(command_counts.cols()));
  std::vector<double> joints(transmission.joint_names.size());
  for (Eigen::Index k = 0; k < command_counts.rows(); ++k) {
    if (k % kTrimRows == 0) TrimSignals();
    // A frame is held for many samples: the same counts are the same angles.
    if (k > 0 && command_counts.row(k) == command_counts.row(k - 1)) {
      angle.row(k) = angle.row(k - 1);
      continue;
    }
    for (std::size_t m = 0; m < counts.size(); ++m) {
      counts[m] = command_counts(k, static_cast<Eigen::Index>(m));
    }
    map.ToJointAngles(std::span<const std::int32_t>(counts), joints);
    for (std::size_t j = 0; j < joints.size(); ++j) angle(k, j) = joints[j];
  }
  return angle;
}

WayOfAngles WayOf(const Trace& trace, const controller::JointMap& joint_map,
                  const controller::TendonTransmission& transmission) {
  return {.raw = JointAngles(joint_map, trace.linearised_angle_rad),
          .filtered = JointAngles(joint_map, trace.filtered_angle_rad),
          .target = trace.target_angle_rad,
          .command = CommandAngles(transmission, trace.command_counts)};
}

}  // namespace gauntlet::sim
