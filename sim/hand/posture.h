#pragma once

#include <span>

#include "sim/hand/hand_model.h"

namespace gauntlet::sim {

/// Joint positions for drawing a recorded posture: fills the qpos of `data`, which is of the whole
/// model, from the joint
/// angles [rad, per joint] and spool angles [rad, per motor] (what follows by a linkage follows)
/// and computes where everything is.
void SetPosture(const HandModel& model, std::span<const double> joint_angle_rad,
                std::span<const double> spool_angle_rad, mjData_& data);

/// Puts the object where it was, for drawing; call SetPosture() afterwards. Without an object
/// nothing happens.
void SetObjectPose(const HandModel& model, std::span<const double> pose, mjData_& data);

}  // namespace gauntlet::sim
