#include "controller/motor_rounding.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "controller/assert.h"

namespace gauntlet::controller {

void MotorRoundingConfig::Visit(SettingsVisitor& visitor) {
  static constexpr std::array<std::string_view, 3> kNames = {"nearest", "hysteresis",
                                                             "noise_shaping"};
  VisitEnum(visitor,
            {"rounding",
             "to whole motor counts: nearest; hysteresis: stays until clearly off; noise_shaping: "
             "takes back the last rounding, exact on average"},
            kNames, rounding);
  visitor.Number({"hysteresis_counts",
                  "how far beyond the middle between two counts a command must be to change "
                  "(rounding: hysteresis)",
                  0, 100},
                 hysteresis_counts);
  visitor.Number(
      {"speed_limit_rad_s", "commands of a spool change no faster; 0 is no limit", 0, 1e4},
      speed_limit_rad_s);
}

MotorRounding::MotorRounding(const MotorRoundingConfig& config, const TendonTransmission& hand,
                             double events_per_s)
    : config_(config),
      min_counts_(hand.min_counts.begin(), hand.min_counts.end()),
      max_counts_(hand.max_counts.begin(), hand.max_counts.end()),
      motors_(hand.counts_per_rad.size()) {
  GAUNTLET_ASSERT(events_per_s > 0.0);
  GAUNTLET_ASSERT(min_counts_.size() == motors_.size() && max_counts_.size() == motors_.size());
  const double limit_rad = config.speed_limit_rad_s > 0.0 ? config.speed_limit_rad_s / events_per_s
                                                          : std::numeric_limits<double>::infinity();
  for (const double counts_per_rad : hand.counts_per_rad) {
    limit_counts_.push_back(std::abs(counts_per_rad) * limit_rad);
  }
  for (std::size_t i = 0; i < motors_.size(); ++i) motors_[i].command = hand.center_counts[i];
  Reset();
}

std::int32_t MotorRounding::Round(Motor& motor) const noexcept {
  switch (config_.rounding) {
    case Rounding::kHysteresis: {
      const double off = std::abs(motor.limited - motor.command);
      if (off <= 0.5 + config_.hysteresis_counts) return motor.command;
      break;
    }
    case Rounding::kNoiseShaping: {
      const double wanted = motor.limited - motor.carried;
      const double rounded = std::round(wanted);
      motor.carried = rounded - wanted;
      return static_cast<std::int32_t>(rounded);
    }
    case Rounding::kNearest:
      break;
  }
  return static_cast<std::int32_t>(std::round(motor.limited));
}

void MotorRounding::Step(std::span<const double> exact_counts,
                         std::span<std::int32_t> motor_counts) noexcept {
  GAUNTLET_ASSERT(exact_counts.size() == motors_.size() && motor_counts.size() == motors_.size());
  for (std::size_t i = 0; i < motors_.size(); ++i) {
    Motor& motor = motors_[i];
    const double limit = limit_counts_[i];
    motor.limited += std::clamp(exact_counts[i] - motor.limited, -limit, limit);
    motor.command = std::clamp(Round(motor), min_counts_[i], max_counts_[i]);
    motor_counts[i] = motor.command;
  }
}

void MotorRounding::Reset() noexcept {
  for (Motor& motor : motors_) motor = {.limited = 1.0 * motor.command, .command = motor.command};
}

void MotorRounding::Reset(std::span<const std::int32_t> motor_counts) noexcept {
  GAUNTLET_ASSERT(motor_counts.size() == motors_.size());
  for (std::size_t i = 0; i < motors_.size(); ++i) motors_[i].command = motor_counts[i];
  Reset();
}

}  // namespace gauntlet::controller
