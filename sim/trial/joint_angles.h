#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

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

/// Angles tick by tick: ticks x joints, or channels [rad].
using AngleRows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// JointAngles() tick by tick.
class JointAngleRows {
 public:
  explicit JointAngleRows(controller::JointMap joint_map);

  /// Ticks x channels in, one tick after the other. Good until the next call, and as long as what
  /// is given: where joints are channels it is that itself.
  Eigen::Map<const AngleRows> Of(std::span<const double> channel_angle_rad);

 private:
  controller::JointMap joint_map_;
  bool are_channels_;  // each joint that of its own number, and nothing else
  AngleRows joint_rad_;
};

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
