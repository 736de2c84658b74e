#include "sim/hand/joint_sensors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string_view>

#include "controller/assert.h"
#include "sim/base/normal_pair.h"
#include "sim/base/signal.h"

namespace gauntlet::sim {

void JointSensorsConfig::Visit(controller::SettingsVisitor& visitor) {
  static constexpr std::array<std::string_view, 2> kKinds = {"none", "encoder"};
  controller::VisitEnum(
      visitor,
      {"kind", "encoder: the angles of all joints are measured, for controllers with a joint_loop"},
      kKinds, kind);
  visitor.Integer({"resolution_bits", "readings have 2^bits steps a turn (encoder)", 6, 24},
                  resolution_bits);
  visitor.Number({"noise_deg", "standard deviation of a reading (encoder)", 0, 30}, noise_deg);
  visitor.Number(
      {"rate_hz", "readings per second, in whole steps of 1 ms or less (encoder)", 1, 10000},
      rate_hz);
  visitor.Number({"delay_ms", "time until the controller has a reading (encoder)", 0, 1000},
                 delay_ms);
}

JointSensors::JointSensors(const JointSensorsConfig& config, const controller::Timing& timing,
                           int joints)
    : config_(config),
      joints_(static_cast<std::size_t>(joints)),
      step_rad_(2.0 * std::numbers::pi / (1 << config.resolution_bits)),
      noise_rad_(config.noise_deg * kRadPerDeg),
      clock_(timing.TicksOf(1e3 / config.rate_hz)),
      is_read_(1 + std::lround(timing.TicksOf(config.delay_ms))) {
  on_the_way_rad_.resize(is_read_.size() * joints_);
  Reset();
}

void JointSensors::Reset() {
  clock_.Reset();
  noise_.clear();
  for (std::size_t joint = 0; joint < joints_; ++joint) {
    noise_.emplace_back(1, "joint sensor", joint);
  }
  std::ranges::fill(is_read_, 0);
  row_ = 0;
}

void JointSensors::Read(std::span<const double> joint_angle_rad,
                        std::span<double> reading_rad) noexcept {
  for (std::size_t i = 0; i < joints_; ++i) {
    const double noisy = joint_angle_rad[i] + noise_rad_ * BoxMuller(noise_[i]).first;
    reading_rad[i] = step_rad_ * std::round(noisy / step_rad_);
  }
}

std::span<const double> JointSensors::Step(std::span<const double> joint_angle_rad) noexcept {
  GAUNTLET_ASSERT(joint_angle_rad.size() == joints_);
  if (!exist()) return {};
  const auto row = [this](std::size_t index) {
    return std::span(on_the_way_rad_).subspan(index * joints_, joints_);
  };
  is_read_[row_] = clock_.Tick() ? 1 : 0;
  if (is_read_[row_] == 1) Read(joint_angle_rad, row(row_));
  row_ = (row_ + 1) % is_read_.size();
  if (is_read_[row_] == 0) return {};
  return row(row_);
}

}  // namespace gauntlet::sim
