#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sim/trial/trial.h"

namespace gauntlet::sim {

/// What the columns of a signal are.
enum class TraceColumns { kChannels, kMotors, kCables, kGrip, kPose };

/// Names of the columns of all signals of one hand.
struct TraceColumnNames {
  const std::vector<std::string>& channels;
  const std::vector<std::string>& motors;
  const std::vector<std::string>& cables;

  const std::vector<std::string>& Of(TraceColumns columns) const {
    static const std::vector<std::string> kGripName = {"object"};
    static const std::vector<std::string> kPoseNames = {"x_m", "y_m", "z_m", "qw",
                                                        "qx",  "qy",  "qz"};
    switch (columns) {
      case TraceColumns::kChannels:
        return channels;
      case TraceColumns::kMotors:
        return motors;
      case TraceColumns::kCables:
        return cables;
      case TraceColumns::kGrip:
        return kGripName;
      case TraceColumns::kPose:
        return kPoseNames;
    }
    return channels;
  }
};

/// Shows every signal of a trace once: `visit(name, unit, columns, matrix)`. The one list that the
/// writers and the reader of trace files share. The last two have no columns, and no place in a
/// file, unless there is an object to grasp.
template <class TraceType, class Visit>
void ForEachSignal(TraceType& trace, Visit&& visit) {
  visit("linearised_angle_rad", "rad", TraceColumns::kChannels, trace.linearised_angle_rad);
  visit("filtered_angle_rad", "rad", TraceColumns::kChannels, trace.filtered_angle_rad);
  visit("command_counts", "counts", TraceColumns::kMotors, trace.command_counts);
  visit("spool_angle_rad", "rad", TraceColumns::kMotors, trace.spool_angle_rad);
  visit("spool_speed_rad_s", "rad/s", TraceColumns::kMotors, trace.spool_speed_rad_s);
  visit("hand_angle_rad", "rad", TraceColumns::kChannels, trace.hand_angle_rad);
  visit("tension_n", "N", TraceColumns::kCables, trace.tension_n);
  visit("grip_force_n", "N", TraceColumns::kGrip, trace.grip_force_n);
  visit("object_pose", "m, quaternion", TraceColumns::kPose, trace.object_pose);
}

}  // namespace gauntlet::sim
