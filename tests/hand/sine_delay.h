#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "tests/hand/hand_fixture.h"

namespace gauntlet::sim::testing {

/// The phase of a signal of 1 Hz, as a delay.
struct SineDelay {
  double in_phase = 0.0;
  double quadrature = 0.0;

  void Add(double value, double phase) {
    in_phase += value * std::sin(phase);
    quadrature -= value * std::cos(phase);
  }
  double Milliseconds() const {
    return 1e3 * std::atan2(quadrature, in_phase) / (2.0 * std::numbers::pi);
  }
};

struct DriveDelay {
  SineDelay spool;
  SineDelay joint;
};

/// A hand whose cables pull with next to nothing: its servos turn nothing but their spools.
inline HandConfig ServosAlone() {
  HandConfig config;
  config.cable.stiffness_scale = 1e-6;
  config.cable.pretension_mm = 0.0;
  config.cable.capstan_friction = 0.0;
  return config;
}

/// How far spool and joint lag behind a sine of 1 Hz that one channel is told in frames of 20 ms,
/// in its third and fourth period. The amplitude is 30 deg, or half the joint's range if that is
/// less.
inline DriveDelay MeasureDelay(Hand& hand, int channel) {
  const controller::TendonTransmission& map = hand.hand_model().transmission();
  const double omega = 2.0 * std::numbers::pi;
  const double amplitude =
      std::min(30.0 * kRadPerDeg, 0.5 * (map.joint_max_rad[channel] - map.joint_min_rad[channel]));
  std::vector<double> angle = map.reference_angle_rad;
  std::vector<double> spool(angle.size());
  hand.Reset(angle);
  DriveDelay delay;
  for (int sample = 0; sample < 4000; ++sample) {
    const double phase = omega * sample * 1e-3;
    if (sample % 20 == 0) {
      angle[channel] = map.reference_angle_rad[channel] + amplitude * std::sin(phase);
      hand.SetCommand(CountsFor(map, angle));
    }
    hand.Step();
    if (sample < 2000) continue;
    hand.ReadSpoolAngles(spool);
    // After the step the time is one sample later.
    delay.spool.Add(spool[channel], phase + omega * 1e-3);
    delay.joint.Add(JointAngles(hand)[channel], phase + omega * 1e-3);
  }
  return delay;
}

}  // namespace gauntlet::sim::testing
