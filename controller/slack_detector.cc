#include "controller/slack_detector.h"

#include <algorithm>
#include <cmath>

#include "controller/angle.h"
#include "controller/assert.h"
#include "controller/number.h"
#include "controller/one_for_each.h"

namespace gauntlet::controller {
namespace {

/// A motor has turned back when it is this far behind its front: more than its sensor jitters.
constexpr double kTurnedBack_rad = 0.5 * kRadPerDeg;

}  // namespace

void SlackDetectorConfig::Visit(SettingsVisitor& visitor) {
  visitor.Numbers(
      {"healthy_friction_nm",
       "friction of each motor with cables as they should be; one for all, or one for each", 0,
       1000},
      healthy_friction_nm);
  visitor.Number({"alarm_share", "less friction than this share of the healthy one is slack", 0, 1},
                 alarm_share);
  visitor.Number({"memory_deg", "turning each way over which friction is averaged", 1, 1e6},
                 memory_deg);
  visitor.Number({"reversal_deg", "turning that does not count after each reversal", 0, 90},
                 reversal_deg);
}

SlackDetector::SlackDetector(const SlackDetectorConfig& config, int motors)
    : alarm_share_(config.alarm_share),
      memory_rad_(config.memory_deg * kRadPerDeg),
      reversal_rad_(config.reversal_deg * kRadPerDeg),
      motors_(static_cast<std::size_t>(motors)),
      friction_nm_(motors_.size()),
      slack_(motors_.size()) {
  CheckSettings(config);
  const Eigen::ArrayXd healthy_nm =
      OneForEach("motor", motors, "healthy_friction_nm", config.healthy_friction_nm);
  healthy_nm_.assign(healthy_nm.begin(), healthy_nm.end());
  Reset();
}

void SlackDetector::Reset() noexcept {
  std::ranges::fill(motors_, Motor{});
  std::ranges::fill(friction_nm_, kNaN);
  std::ranges::fill(slack_, 0);
}

void SlackDetector::StepMotor(Motor& motor, double angle_rad, double torque_nm) const noexcept {
  if (!motor.seen) {
    motor.seen = true;
    motor.front_rad = angle_rad;
  }
  const double ahead = motor.direction * (angle_rad - motor.front_rad);
  if (ahead < -kTurnedBack_rad) {
    motor.direction = -motor.direction;
    motor.since_rad = -ahead;
    motor.front_rad = angle_rad;
  } else if (ahead > 0.0) {
    motor.since_rad += ahead;
    motor.front_rad = angle_rad;
    if (motor.since_rad < reversal_rad_) return;
    Turning& turning = motor.turning[motor.direction > 0 ? 1 : 0];
    turning.turned_rad += ahead;
    // At first the plain mean, from memory_deg on an exponential one.
    const double memory = std::min(turning.turned_rad, memory_rad_);
    turning.mean_nm += std::min(1.0, ahead / memory) * (torque_nm - turning.mean_nm);
  }
}

void SlackDetector::Step(std::span<const double> angle_rad,
                         std::span<const double> torque_nm) noexcept {
  GAUNTLET_ASSERT(angle_rad.size() == motors_.size() && torque_nm.size() == motors_.size());
  for (std::size_t i = 0; i < motors_.size(); ++i) {
    if (!std::isfinite(angle_rad[i]) || !std::isfinite(torque_nm[i])) continue;
    Motor& motor = motors_[i];
    StepMotor(motor, angle_rad[i], torque_nm[i]);
    const auto& [back, forward] = motor.turning;
    if (std::min(back.turned_rad, forward.turned_rad) < memory_rad_) continue;
    friction_nm_[i] = 0.5 * (forward.mean_nm - back.mean_nm);
    slack_[i] = friction_nm_[i] < alarm_share_ * healthy_nm_[i] ? 1 : 0;
  }
}

}  // namespace gauntlet::controller
