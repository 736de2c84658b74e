#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "tests/hand/hand_fixture.h"
#include "tests/hand/sine_delay.h"

namespace gauntlet::sim::testing {

/// How a servo answers a step that is commanded once; times from the command on.
struct StepResponse {
  double first_motion_ms = 0.0;  // 0.5 deg from where it stood
  double earliest_ms = 0.0;      // the least of those, and the most
  double latest_ms = 0.0;
  double rise_ms = 0.0;  // from 10 to 90 % of the step
  double overshoot_deg = 0.0;
  double error_deg = 0.0;  // 0.7 s later
};

/// The motors of the fingers, which are alike: their frames differ.
inline std::vector<int> FingerMotors() {
  std::vector<int> motors;
  for (const char* finger : {"index", "middle", "ring", "little"}) {
    for (const char* joint : {"_mcp", "_pip"}) {
      motors.push_back(ChannelIndex(std::string(finger) + joint));
    }
  }
  return motors;
}

/// Servos of this kind that turn nothing but their spools.
inline Hand ServosOfKind(const ServoConfig& servo) {
  HandConfig config = ServosAlone();
  config.servo = servo;
  config.servo.numbers().play_deg = 0.0;
  return Hand(MakeModel(config));
}

/// Mean of all finger motors and of commands at three moments of a frame.
inline StepResponse MeasureStep(const ServoConfig& servo, double step_deg) {
  Hand hand = ServosOfKind(servo);
  const controller::TendonTransmission& map = hand.hand_model().transmission();
  const std::vector<int> motors = FingerMotors();
  const double from_rad = -60.0 * kRadPerDeg;
  const auto counts = [&](double spool_rad) {
    std::vector<std::int32_t> command(map.center_counts.begin(), map.center_counts.end());
    for (int motor : motors) command[motor] = std::lround(map.ToCounts(motor, spool_rad));
    return command;
  };
  StepResponse mean{.earliest_ms = 1e9};
  constexpr int kMoments = 3;
  const double weight = 1.0 / (kMoments * static_cast<double>(motors.size()));
  for (int moment = 0; moment < kMoments; ++moment) {
    hand.Reset(map.reference_angle_rad);
    hand.SetCommand(counts(from_rad));
    StepTimes(hand, 1500 + 7 * moment);
    std::vector<double> start_rad(map.motor_names.size());
    hand.ReadSpoolAngles(start_rad);
    hand.SetCommand(counts(from_rad + step_deg * kRadPerDeg));
    std::vector<int> first(start_rad.size(), 0), low(first), high(first);
    std::vector<double> most(start_rad.size(), 0.0), turned(most), angle_rad(most);
    for (int sample = 1; sample <= 700; ++sample) {
      hand.Step();
      hand.ReadSpoolAngles(angle_rad);
      for (int motor : motors) {
        turned[motor] = (angle_rad[motor] - start_rad[motor]) * kDegPerRad;
        if (first[motor] == 0 && turned[motor] > 0.5) first[motor] = sample;
        if (low[motor] == 0 && turned[motor] > 0.1 * step_deg) low[motor] = sample;
        if (high[motor] == 0 && turned[motor] > 0.9 * step_deg) high[motor] = sample;
        most[motor] = std::max(most[motor], turned[motor]);
      }
    }
    for (int motor : motors) {
      mean.first_motion_ms += weight * first[motor];
      mean.earliest_ms = std::min<double>(mean.earliest_ms, first[motor]);
      mean.latest_ms = std::max<double>(mean.latest_ms, first[motor]);
      mean.rise_ms += weight * (high[motor] - low[motor]);
      mean.overshoot_deg += weight * std::max(0.0, most[motor] - step_deg);
      mean.error_deg += weight * std::abs(turned[motor] - step_deg);
    }
  }
  return mean;
}

/// Behind a sine of 1 Hz and 30 deg of the spool, sent in frames of 20 ms; mean of all finger
/// motors.
inline double MeasureSineDelay(const ServoConfig& servo) {
  Hand hand = ServosOfKind(servo);
  const controller::TendonTransmission& map = hand.hand_model().transmission();
  const std::vector<int> motors = FingerMotors();
  hand.Reset(map.reference_angle_rad);
  std::vector<std::int32_t> command(map.center_counts.begin(), map.center_counts.end());
  std::vector<double> angle_rad(map.motor_names.size());
  std::vector<SineDelay> delay(motors.size());
  const double omega = 2.0 * std::numbers::pi;
  for (int sample = 0; sample < 4000; ++sample) {
    if (sample % 20 == 0) {
      const double sine_rad = 30.0 * kRadPerDeg * std::sin(omega * sample * 1e-3);
      for (int motor : motors) command[motor] = std::lround(map.ToCounts(motor, sine_rad));
      hand.SetCommand(command);
    }
    hand.Step();
    if (sample < 2000) continue;
    hand.ReadSpoolAngles(angle_rad);
    for (std::size_t i = 0; i < motors.size(); ++i) {
      delay[i].Add(angle_rad[motors[i]], omega * (sample + 1) * 1e-3);
    }
  }
  double sum_ms = 0.0;
  for (const SineDelay& of_motor : delay) sum_ms += of_motor.Milliseconds();
  return sum_ms / static_cast<double>(delay.size());
}

/// What was measured of a real servo, and by whom.
struct PublishedFigure {
  const char* kind;
  const char* what;
  double step_deg;  // 0: behind a sine
  bool first_motion;
  double published_ms;
  const char* source;

  double Simulated(const ServoConfig& servo) const {
    if (step_deg == 0.0) return MeasureSineDelay(servo);
    const StepResponse response = MeasureStep(servo, step_deg);
    return first_motion ? response.first_motion_ms : response.rise_ms;
  }
};

/// The middle where a range is published. SG-90: log.txt of 52 steps at 75 Hz, frames of 20 ms,
/// 26 to 55 ms until the first motion; 53 to 68 ms for 10 deg, 93 to 108 for 60.
inline const std::vector<PublishedFigure>& PublishedFigures() {
  constexpr const char* kSg90 = "JasperGrant/SG-90-Servo-Characterization @0a72abc";
  constexpr const char* kSts3215 = "giacomoran/so101-data-collection @6658923";
  static const std::vector<PublishedFigure> kFigures = {
      {"rc_analog", "first motion", 20.0, true, 42.0, kSg90},
      {"rc_analog", "10 to 90 % of 10 deg", 10.0, false, 60.0, kSg90},
      {"rc_analog", "10 to 90 % of 20 deg", 20.0, false, 67.0, kSg90},
      {"rc_analog", "10 to 90 % of 60 deg", 60.0, false, 100.0, kSg90},
      {"rc_analog", "10 to 90 % of 90 deg", 90.0, false, 134.0, kSg90},
      {"rc_analog", "10 to 90 % of 135 deg", 135.0, false, 188.0, kSg90},
      {"bus", "behind a sine of 1 Hz", 0.0, false, 100.0, kSts3215},
  };
  return kFigures;
}

}  // namespace gauntlet::sim::testing
