#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "controller/export.h"
#include "controller/settings.h"

namespace gauntlet::controller {

/// Settings of a SlackDetector.
struct GAUNTLET_API SlackDetectorConfig {
  /// Per motor, what friction_nm() said when the cables were as they should be.
  std::vector<double> healthy_friction_nm = {0.0};
  double alarm_share = 0.65;  // of the healthy friction
  double memory_deg = 600.0;  // of turning each way, over which friction is averaged
  double reversal_deg = 4.0;  // of turning that do not count after each reversal

  void Visit(SettingsVisitor& visitor);
};

/// Finds cables that have gone slack from what motors tell of themselves: angle and torque.
///
///     friction = (mean torque turning forward - mean torque turning back) / 2
///     alarm:     friction < alarm_share healthy_friction
///
/// Cables rub in proportion to their tension (the capstan law), so a pre-tensioned pair that has
/// lost its pretension lets its motor turn more easily, long before play is seen. What pulls both
/// ways alike (gravity, springs, what is held) is in neither; a load makes friction larger and
/// raises no alarm. Means are taken over the angle turned, so that rests and what accelerates do
/// not count, and begin `reversal_deg` behind each reversal, where cables have taken up their
/// stretch.
///
/// Shapes: one value per motor. Units: rad, N m; torque in the direction of the angle, its mean
/// since the last reading: servos that take commands in frames give it in kicks.
/// Errors: SettingError.
class GAUNTLET_API SlackDetector {
 public:
  SlackDetector(const SlackDetectorConfig& config, int motors);

  /// A reading of all motors, as often as there are readings.
  void Step(std::span<const double> angle_rad, std::span<const double> torque_nm) noexcept;
  /// Forgets what it has seen.
  void Reset() noexcept;

  /// 1 per motor whose cables are slack; 0 also until it has turned by memory_deg each way.
  std::span<const std::uint8_t> slack() const noexcept { return slack_; }
  /// NaN until the motor has turned by memory_deg each way.
  std::span<const double> friction_nm() const noexcept { return friction_nm_; }

 private:
  struct Turning {
    double mean_nm = 0.0;
    double turned_rad = 0.0;
  };
  struct Motor {
    bool seen = false;
    double front_rad = 0.0;  // the farthest in the direction in which it turns
    double since_rad = 0.0;  // and how far that is from the last reversal
    int direction = 1;
    Turning turning[2];  // back, forward
  };
  void StepMotor(Motor& motor, double angle_rad, double torque_nm) const noexcept;

  double alarm_share_;
  double memory_rad_;
  double reversal_rad_;
  std::vector<double> healthy_nm_;
  std::vector<Motor> motors_;
  std::vector<double> friction_nm_;
  std::vector<std::uint8_t> slack_;
};

}  // namespace gauntlet::controller
