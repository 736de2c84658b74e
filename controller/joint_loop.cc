#include "controller/joint_loop.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "controller/angle.h"
#include "controller/assert.h"
#include "controller/one_for_each.h"

namespace gauntlet::controller {
namespace {

/// The part of a value that is beyond +-band.
double Beyond(double value, double band) noexcept {
  return std::copysign(std::max(0.0, std::abs(value) - band), value);
}

}  // namespace

void JointLoopConfig::Visit(SettingsVisitor& visitor) {
  static constexpr std::array<std::string_view, 2> kNames = {"none", "pi"};
  VisitEnum(visitor,
            {"kind",
             "pi: commands are corrected until measured joints reach their targets (needs "
             "hand.joint_sensors, but with gains of 0); it steps with the command frames"},
            kNames, kind);
  visitor.Number({"proportional", "so much of a joint's error is added to its command (pi)", 0, 2},
                 proportional);
  visitor.Number(
      {"integral_per_s",
       "so much of a joint's error is added to its command per second, and stays (pi)", 0, 50},
      integral_per_s);
  visitor.Number({"max_correction_deg", "no command is moved by more (pi)", 0, 90},
                 max_correction_deg);
  visitor.Number({"expected_delay_ms",
                  "delay of the hand without the loop: measured angles are compared with the "
                  "targets of that time (pi)",
                  0, 1000},
                 expected_delay_ms);
  visitor.Number({"dead_band_deg",
                  "errors up to this, and half the turn of a motor count, are left (pi)", 0, 30},
                 dead_band_deg);
  visitor.Numbers({"friction_deg",
                   "half the width of a joint's hysteresis, added in the direction of the target; "
                   "one for all joints, or one for each (pi)",
                   0, 30},
                  friction_deg);
  visitor.Number(
      {"friction_turn_deg",
       "so far a joint must be told to come back before it counts as turned (pi)", 0, 30},
      friction_turn_deg);
  visitor.Number({"stale_after_ms", "measured angles that are older are not used (pi)", 0, 10000},
                 stale_after_ms);
}

JointLoop::JointLoop(const JointLoopConfig& config, const TendonTransmission& hand,
                     double events_per_s)
    : config_(config),
      event_s_(1.0 / events_per_s),
      delay_events_(1e-3 * config.expected_delay_ms * events_per_s),
      stale_events_(1e-3 * config.stale_after_ms * events_per_s),
      limit_rad_(config.max_correction_deg * kRadPerDeg),
      half_turn_rad_(0.5 * config.friction_turn_deg * kRadPerDeg) {
  GAUNTLET_ASSERT(events_per_s > 0.0);
  CheckSettings(config);
  if (!on()) return;
  const bool measures = config.proportional > 0.0 || config.integral_per_s > 0.0;
  if (measures && !hand.joint_sensors) {
    throw SettingError("kind",
                       "pi needs a hand that measures its joints (hand.joint_sensors); with "
                       "proportional and integral_per_s 0 it compensates friction without");
  }
  const auto joint_count = static_cast<int>(hand.joint_names.size());
  const Eigen::ArrayXd friction_deg =
      OneForEach("joint", joint_count, "friction_deg", config.friction_deg);
  const Eigen::MatrixXd turn_rad = TendonMap(hand, true).AnglePerCount().cwiseAbs();
  for (int i = 0; i < joint_count; ++i) {
    const double count_rad = turn_rad.row(i).maxCoeff();
    joints_.push_back({.friction_rad = friction_deg[i] * kRadPerDeg,
                       .dead_band_rad = config.dead_band_deg * kRadPerDeg + 0.5 * count_rad,
                       .min_rad = hand.joint_min_rad[i],
                       .max_rad = hand.joint_max_rad[i],
                       .decided = std::isfinite(count_rad)});
  }
  memory_.resize(joints_.size());
  targets_rad_.resize((static_cast<std::size_t>(delay_events_) + 2) * joints_.size());
  Reset(hand.reference_angle_rad);
}

void JointLoop::Reset(std::span<const double> target_rad) noexcept {
  GAUNTLET_ASSERT(!on() || target_rad.size() == joints_.size());
  if (!on()) return;
  events_since_reading_ = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < targets_rad_.size(); ++i) {
    targets_rad_[i] = target_rad[i % joints_.size()];
  }
  for (std::size_t i = 0; i < memory_.size(); ++i) memory_[i] = {.turn_rad = target_rad[i]};
}

void JointLoop::SetMeasuredAngles(std::span<const double> measured_rad) noexcept {
  if (!on() || measured_rad.size() != memory_.size()) return;
  for (std::size_t i = 0; i < memory_.size(); ++i) memory_[i].measured_rad = measured_rad[i];
  events_since_reading_ = 0.0;
}

/// The target of this joint as it was `expected_delay_ms` ago, between two events a line.
double JointLoop::ReferenceOf(std::size_t joint) const noexcept {
  const std::size_t rows = targets_rad_.size() / joints_.size();
  const auto whole = static_cast<std::size_t>(delay_events_);
  const auto target = [&](std::size_t events_ago) {
    return targets_rad_[(newest_row_ + rows - events_ago) % rows * joints_.size() + joint];
  };
  const double later = target(whole);
  return later + (delay_events_ - static_cast<double>(whole)) * (target(whole + 1) - later);
}

double JointLoop::CorrectionOf(const Joint& joint, double error_rad, double least_rad,
                               double most_rad, Memory& memory) const noexcept {
  const double error = Beyond(error_rad, joint.dead_band_rad);
  const double others = config_.proportional * error + joint.friction_rad * memory.direction;
  const double wanted = others + memory.integral_rad;
  const bool pushes_on = error > 0.0 ? wanted >= most_rad : wanted <= least_rad;
  if (!pushes_on) memory.integral_rad += config_.integral_per_s * event_s_ * error;
  return std::clamp(others + memory.integral_rad, least_rad, most_rad);
}

void JointLoop::Step(std::span<const double> target_rad, std::span<double> corrected_rad) noexcept {
  GAUNTLET_ASSERT(on() && target_rad.size() == joints_.size() &&
                  corrected_rad.size() == joints_.size());
  newest_row_ = (newest_row_ + 1) % (targets_rad_.size() / joints_.size());
  const bool fresh = events_since_reading_ <= stale_events_;
  events_since_reading_ += 1.0;
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    const Joint& joint = joints_[i];
    Memory& memory = memory_[i];
    const double target = std::clamp(target_rad[i], joint.min_rad, joint.max_rad);
    targets_rad_[newest_row_ * joints_.size() + i] = target;
    corrected_rad[i] = target;
    if (!joint.decided) continue;
    if (std::abs(target - memory.turn_rad) > half_turn_rad_) {
      memory.direction = target > memory.turn_rad ? 1.0 : -1.0;
      memory.turn_rad = target - half_turn_rad_ * memory.direction;
    }
    const bool usable = fresh && std::isfinite(memory.measured_rad);
    const double error = usable ? ReferenceOf(i) - memory.measured_rad : 0.0;
    corrected_rad[i] += CorrectionOf(joint, error, std::max(-limit_rad_, joint.min_rad - target),
                                     std::min(limit_rad_, joint.max_rad - target), memory);
  }
}

void JointLoop::SwapMemory(JointLoop& from, std::span<const double> target_rad) noexcept {
  Reset(target_rad);
  if (!on() || !from.on()) return;
  memory_.swap(from.memory_);
  events_since_reading_ = from.events_since_reading_;
  if (targets_rad_.size() != from.targets_rad_.size()) return;
  targets_rad_.swap(from.targets_rad_);
  std::swap(newest_row_, from.newest_row_);
}

}  // namespace gauntlet::controller
