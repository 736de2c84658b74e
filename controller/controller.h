#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "controller/controller_config.h"

namespace gauntlet::controller {

/// One sample of the data glove, as the analog-digital converter gives it.
///
/// Shapes: one value per channel. Units: counts. NaN stands for a missing value.
struct GloveSample {
  std::span<const double> counts;
};

/// What the motors are told. Valid until the next Step() of the controller that gave it.
///
/// Shapes: one value per motor. Units: motor counts, always within the motor's range.
struct Command {
  std::span<const std::int32_t> motor_counts;
};

/// From glove to motors: linearisation, filters and tendon map, in one call per sample.
///
///     counts -> [filter] -> linearisation -> [filter] -> tendon map -> integer motor command
///
/// Call Step() once per sampling period (1 ms by default). It neither throws, allocates, locks nor
/// reads a clock. An event is every `samples_per_event`-th call, beginning with the first: only
/// there does the command change. A value that is missing or not finite never reaches a motor: its
/// channel holds the last good value and counts the event.
///
/// Errors: the constructor throws SettingError, which names the key and the allowed range.
class Controller {
 public:
  /// `glove` and `hand` say what the controller is connected to; `config` says what it does.
  Controller(const ControllerConfig& config, const GloveCalibration& glove,
             const TendonTransmission& hand);
  ~Controller();
  Controller(Controller&&) noexcept;
  Controller& operator=(Controller&&) noexcept;

  Command Step(const GloveSample& sample) noexcept;
  void Reset() noexcept;

  int channel_count() const noexcept;
  int motor_count() const noexcept;

  /// Joint angles of the last Step(), before and behind the filter [rad], one per channel.
  std::span<const double> linearised_angle_rad() const noexcept;
  std::span<const double> filtered_angle_rad() const noexcept;
  /// How many samples of each channel could not be trusted since Reset().
  std::span<const std::int64_t> untrusted_samples() const noexcept;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gauntlet::controller
