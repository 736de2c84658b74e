#pragma once

#include <mujoco/mujoco.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "sim/base/channels.h"
#include "sim/base/random.h"
#include "sim/base/signal.h"
#include "sim/hand/hand.h"
#include "sim/hand/posture.h"

namespace gauntlet::sim::testing {

/// Servos whose gain leaves little of an error, in step with the commands: what is seen is cables
/// and joints.
inline HandConfig StiffServos() {
  HandConfig config;
  config.servo.settings = StandardServo{};
  config.arm_servo.settings = StandardServo{};
  return config;
}

/// No friction, no dead band, 16-bit commands: what is left is stretch and gravity.
inline HandConfig FrictionFree() {
  HandConfig config = StiffServos();
  config.cable.capstan_friction = 0.0;
  for (ServoConfig* servo : {&config.servo, &config.arm_servo}) {
    servo->numbers().dead_band_deg = 0.0;
    servo->numbers().resolution_bits = 16;
  }
  return config;
}

inline std::shared_ptr<const HandModel> MakeModel(const HandConfig& config = {}) {
  return std::make_shared<const HandModel>(config);
}

/// The command for a posture, with or without undoing the coupling.
inline std::vector<std::int32_t> CountsFor(const controller::TendonTransmission& map,
                                           std::span<const double> angle_rad,
                                           bool compensate = true) {
  const std::size_t count = map.motor_names.size();
  std::vector<std::int32_t> counts(count);
  for (std::size_t motor = 0; motor < count; ++motor) {
    double spool = 0.0;
    for (std::size_t channel = 0; channel < count; ++channel) {
      if (!compensate && channel != motor) continue;
      spool += map.coupling[motor * count + channel] *
               (angle_rad[channel] - map.reference_angle_rad[channel]);
    }
    counts[motor] = static_cast<std::int32_t>(
        std::lround(map.center_counts[motor] + map.counts_per_rad[motor] * spool));
  }
  return counts;
}

/// A posture from which every channel can be moved alone: arm bent, hand half open.
inline std::vector<double> HomePosture(const controller::TendonTransmission& map) {
  std::vector<double> angle(map.joint_names.size());
  for (std::size_t i = 0; i < angle.size(); ++i) {
    angle[i] = map.joint_min_rad[i] + 0.4 * (map.joint_max_rad[i] - map.joint_min_rad[i]);
  }
  return angle;
}

inline std::vector<double> RandomPosture(const controller::TendonTransmission& map,
                                         RandomStream& random) {
  std::vector<double> angle(map.joint_names.size());
  for (std::size_t i = 0; i < angle.size(); ++i) {
    angle[i] = random.Uniform(map.joint_min_rad[i], map.joint_max_rad[i]);
  }
  return angle;
}

inline std::vector<double> JointAngles(const Hand& hand) {
  std::vector<double> angle(hand.hand_model().drives().size());
  hand.ReadJointAngles(angle);
  return angle;
}

inline void StepTimes(Hand& hand, int samples) {
  for (int i = 0; i < samples; ++i) hand.Step();
}

}  // namespace gauntlet::sim::testing
