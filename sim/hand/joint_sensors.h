#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "controller/periodic_clock.h"
#include "controller/timing.h"
#include "sim/base/random.h"
#include "sim/hand/hand_config.h"

namespace gauntlet::sim {

/// Readings of a hand's joint sensors, and their times.
///
///     reading = step round((angle + noise) / step),   step = 2 pi / 2^resolution_bits
///
/// of all joints at once, every 1 / rate_hz from the first tick on, and there after the delay. The
/// noise is the same in every run. Shapes: one value per joint. Units: rad.
class JointSensors {
 public:
  JointSensors(const JointSensorsConfig& config, const controller::Timing& timing, int joints);

  bool exist() const noexcept { return config_.kind != JointSensorsKind::kNone; }
  /// As new; no reading is on its way.
  void Reset();
  /// One tick with joints at these angles: the reading that arrives at it, or an empty one.
  std::span<const double> Step(std::span<const double> joint_angle_rad) noexcept;

 private:
  void Read(std::span<const double> joint_angle_rad, std::span<double> reading_rad) noexcept;

  JointSensorsConfig config_;
  std::size_t joints_;
  double step_rad_;
  double noise_rad_;
  controller::PeriodicClock clock_;
  std::vector<RandomStream> noise_;     // per joint
  std::vector<double> on_the_way_rad_;  // a row of joints for each tick of the delay; a ring
  std::vector<std::uint8_t> is_read_;   // per row: it has a reading
  std::size_t row_ = 0;
};

}  // namespace gauntlet::sim
