#pragma once

#include <filesystem>
#include <span>

#include "sim/base/signal.h"
#include "sim/glove/glove.h"
#include "sim/hand/hand_model.h"
#include "sim/trial/trace.h"

namespace gauntlet::sim {

/// The signals of all controllers as an MCAP file for Foxglove, PlotJuggler and rerun. Messages are
/// those of ROS 2 in CDR, because all of these programs plot sensor_msgs/JointState. Angles [rad]
/// are its positions, speeds [rad/s] its velocities; names are those of joints, channels or motors.
/// Other signals are of the type gauntlet/Signal, whose definition is in the file. Topics:
/// `/wearer/true_angle_rad`, `/glove/counts`, `/reference_angle_rad`, and `/CONTROLLER/SIGNAL` for
/// each controller. The time of a message is that of the trial, from 0. Errors: RunError.
void WriteTraceMcap(const std::filesystem::path& target, const GloveSignal& glove,
                    const Signal& reference_rad, const HandModel& hand,
                    std::span<const Trace> traces);

}  // namespace gauntlet::sim
