#pragma once

#include <Eigen/Core>

#include "controller/controller_config.h"
#include "sim/base/signal.h"
#include "sim/trial/trace.h"

namespace gauntlet::sim {

/// Joint angles that the channels ask for: the joint map, row by row.
/// Shapes: ticks x channels in, ticks x joints out. Units: rad.
Signal JointAngles(const controller::JointMap& joint_map, const Signal& channel_angle_rad);

/// Reference of the hand's joints: the joint map of the wearer's true angles, as trace.h5
/// holds it (see Stored). Shapes and units as above.
Signal ReferenceAngles(const controller::JointMap& joint_map, const Signal& true_angle_rad);

/// A command as the posture that it asks of a hand whose cables neither stretch nor go slack; NaN
/// for joints that springs decide. Shapes: ticks x motors in, ticks x joints out. Units: counts in,
/// rad out.
Signal CommandAngles(const controller::TendonTransmission& transmission,
                     const IntegerSignal& command_counts);

/// Stages of a trial's samples, as angles of the hand's joints, ticks x joints [rad].
struct WayOfAngles {
  Signal raw;       // as linearised, before the filter
  Signal filtered;  // behind it
  Signal target;    // behind prediction: what the hand was last asked for
  Signal command;   // the frame that the servos hold
};
WayOfAngles WayOf(const Trace& trace, const controller::JointMap& joint_map,
                  const controller::TendonTransmission& transmission);

}  // namespace gauntlet::sim
