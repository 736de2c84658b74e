#include "sim/trial/joint_angles.h"

#include <cstdint>

#include "controller/assert.h"
#include "controller/tendon_map.h"

namespace gauntlet::sim {
namespace {

/// Between two columns: few rows fill no memory, and are not worth the question.
void TrimBeside(const Signal& signal) {
  if (signal.rows() >= kTrimRows) TrimSignals();
}

/// Puts the angle that the channels ask of one joint into `angle_rad`.
void PutJointAngle(const controller::JointMap& joint_map, int joint,
                   const Eigen::Ref<const Eigen::MatrixXd>& channel_angle_rad,
                   Eigen::Ref<Eigen::VectorXd> angle_rad) {
  const auto& terms = joint_map.terms(joint);
  if (terms.empty()) angle_rad.setConstant(joint_map.offset_rad(joint));
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const auto part = terms[i].weight * channel_angle_rad.col(terms[i].channel).array();
    if (i == 0) {
      angle_rad = joint_map.offset_rad(joint) + part;
    } else {
      angle_rad.array() += part;
    }
  }
}

}  // namespace

Signal JointAngles(const controller::JointMap& joint_map, const Signal& channel_angle_rad) {
  GAUNTLET_ASSERT(channel_angle_rad.cols() == joint_map.channel_count());
  Signal joints(channel_angle_rad.rows(), joint_map.joint_count());
  for (int joint = 0; joint < joint_map.joint_count(); ++joint) {
    PutJointAngle(joint_map, joint, channel_angle_rad, joints.col(joint));
    TrimBeside(joints);
  }
  return joints;
}

Signal ReferenceAngles(const controller::JointMap& joint_map, const Signal& true_angle_rad) {
  Signal reference = JointAngles(joint_map, true_angle_rad);
  for (Eigen::Index joint = 0; joint < reference.cols(); ++joint) {
    auto column = reference.col(joint);
    column = column.cast<Stored<double>>().cast<double>();
    TrimBeside(reference);
  }
  return reference;
}

Signal CommandAngles(const controller::TendonTransmission& transmission,
                     const IntegerSignal& command_counts) {
  controller::TendonMap map(transmission, true);
  GAUNTLET_ASSERT(command_counts.cols() == map.motor_count());
  Signal angle(command_counts.rows(), map.joint_count());
  std::vector<std::int32_t> counts(static_cast<std::size_t>(command_counts.cols()));
  std::vector<double> joints(transmission.joint_names.size());
  Eigen::Index end = 0;
  for (Eigen::Index begin = 0; begin < command_counts.rows(); begin = end) {
    // A frame is held for many samples: the same counts are the same angles.
    for (end = begin + 1; end < command_counts.rows() && end - begin < kTrimRows; ++end) {
      if (command_counts.row(end) != command_counts.row(begin)) break;
    }
    for (std::size_t m = 0; m < counts.size(); ++m) {
      counts[m] = command_counts(begin, static_cast<Eigen::Index>(m));
    }
    map.ToJointAngles(std::span<const std::int32_t>(counts), joints);
    for (std::size_t j = 0; j < joints.size(); ++j) {
      angle.col(j).segment(begin, end - begin).setConstant(joints[j]);
    }
    if (begin / kTrimRows != end / kTrimRows) TrimSignals();
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
