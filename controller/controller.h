#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "controller/controller_config.h"
#include "controller/sample_guard.h"

namespace gauntlet::controller {

/// What the motors are told. Valid until the next Step() of the controller that gave it.
///
/// Shapes: one value per motor. Units: motor counts, always within the motor's range.
struct Command {
  std::span<const std::int32_t> motor_counts;
};

/// From glove to motors: linearisation, filters, prediction and tendon map, in one call per sample.
///
///     counts -> [filter] -> linearisation -> [filter] -> [prediction] -> tendon map -> counts
///
/// Call Step() once per sampling period (1 ms by default). It neither throws, allocates, locks nor
/// reads a clock. An event is every `samples_per_event`-th call, beginning with the first: only
/// there does the command change. A value that cannot be trusted (see Untrusted) never reaches a
/// motor: its channel holds the last good value and counts the event; before the first good value
/// it holds the reference angle. Prediction steps when the filter does.
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

  /// Other settings from the next sample on. Filters of the same kind and memory go on where they
  /// were, so that channels whose settings stay the same keep every bit; others start at the next
  /// sample, and the motors' speed limit keeps the change smooth.
  /// Allocates: not for the thread that calls Step(). Errors: SettingError, and nothing is changed.
  void Load(const ControllerConfig& config);

  /// A channel that is switched off holds its joint where it is; switched on again its filters
  /// start at the next sample. The other channels do not notice.
  void SetChannelActive(int channel, bool active) noexcept;
  bool channel_active(int channel) const noexcept;

  int channel_count() const noexcept;
  int motor_count() const noexcept;

  /// Joint angles of the last Step() [rad], one per channel: before the filter, behind it, and
  /// behind the prediction, which is what the motors are to do.
  std::span<const double> linearised_angle_rad() const noexcept;
  std::span<const double> filtered_angle_rad() const noexcept;
  std::span<const double> target_angle_rad() const noexcept;
  /// How many samples of each channel could not be trusted since Reset(), in all or for one reason.
  std::span<const std::int64_t> untrusted_samples() const noexcept;
  std::span<const std::int64_t> untrusted_samples(Untrusted kind) const noexcept;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gauntlet::controller
