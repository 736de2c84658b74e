#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "controller/controller_config.h"

namespace gauntlet::controller {

/// From exact motor positions to the whole counts of a command frame, once per event.
///
///     limited = previous limited + clamp(exact - previous limited, -L, +L)
///     nearest:       c = round(limited)
///     hysteresis:    c stays while |limited - c| <= 0.5 + hysteresis_counts, else round(limited)
///     noise_shaping: c = round(limited - e), e = c - (limited - e): what rounding added last time
///                    is taken away this time, so that the mean over frames is exact
///
/// L is `speed_limit_rad_s` per event; two commands differ by at most L and the rounding.
/// The first command is limited, too: from where the motors are.
/// Units: motor counts. Shapes: one value per motor.
class MotorRounding {
 public:
  /// The motors are at their centers.
  MotorRounding(const MotorRoundingConfig& config, const TendonTransmission& hand,
                double events_per_s);

  void Step(std::span<const double> exact_counts, std::span<std::int32_t> motor_counts) noexcept;
  /// As new, with the motors where the last command has sent them, or at these counts.
  void Reset() noexcept;
  void Reset(std::span<const std::int32_t> motor_counts) noexcept;
  /// Takes the motors of another one for the same hand, which goes on with these. Settings stay.
  void SwapMemory(MotorRounding& from) noexcept { motors_.swap(from.motors_); }

 private:
  struct Motor {
    double limited = 0.0;
    double carried = 0.0;  // what the last rounding added
    std::int32_t command = 0;
  };
  std::int32_t Round(Motor& motor) const noexcept;

  MotorRoundingConfig config_;
  std::vector<double> limit_counts_;  // per event; infinite without a limit
  std::vector<std::int32_t> min_counts_;
  std::vector<std::int32_t> max_counts_;
  std::vector<Motor> motors_;
};

}  // namespace gauntlet::controller
