#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "controller/controller.h"
#include "sim/base/signal.h"
#include "sim/glove/glove.h"
#include "sim/hand/hand.h"
#include "sim/loop/event_config.h"

namespace gauntlet::sim {

/// Everything that happened in one trial, one row per sample.
struct Trace {
  std::string controller_name;
  Signal linearised_angle_rad;           // samples x channels: before the filter
  Signal filtered_angle_rad;             // samples x channels
  IntegerSignal command_counts;          // samples x motors: the frame that the servos hold
  Signal spool_angle_rad;                // samples x motors
  Signal spool_speed_rad_s;              // samples x motors
  Signal hand_angle_rad;                 // samples x channels
  Signal tension_n;                      // samples x cables
  Signal grip_force_n;                   // samples x 1; no columns without an object
  Signal object_pose;                    // samples x 7: position [m] and quaternion; as above
  std::vector<double> saturation_share;  // per motor
  std::vector<std::int64_t> untrusted_samples;  // per channel
  HandHealth health;  // not ok: the signals end at the moment of the problem
};

/// The one loop in which simulated time advances: glove sample -> controller -> event -> hand.
/// Deterministic: same arguments, same bytes.
/// `keep_going` is asked now and then; false stops the trial by a Cancelled exception.
Trace RunTrial(const std::string& controller_name, const controller::ControllerConfig& controller,
               const GloveSignal& glove, const controller::GloveCalibration& calibration,
               const EventConfig& event, std::shared_ptr<const HandModel> hand,
               const std::function<bool()>& keep_going = {});

}  // namespace gauntlet::sim
