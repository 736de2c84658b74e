#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "controller/controller_config.h"
#include "controller/timing.h"
#include "sim/trial/link/link_config.h"

namespace gauntlet::sim {

/// Watches how long frames stay away, and what the motors do meanwhile. It counts from the first
/// frame on. After a gap it follows again once `good_frames` have come, none of them later than the
/// time until hold, and not faster than its speed until it has caught up.
///
/// Shapes: one value per motor. Units: counts, ticks. It neither throws nor allocates after its
/// construction.
class Watchdog {
 public:
  enum class Tier : std::uint8_t { kFollow, kHold, kRelax, kOff };

  /// Errors: SettingError for tiers that are not in order.
  Watchdog(const WatchdogConfig& config, const controller::TendonTransmission& hand,
           const controller::Timing& timing);

  bool exists() const noexcept { return exists_; }
  /// The motors hold these counts.
  void Reset(std::span<const std::int32_t> motor_counts);
  /// One tick: whether a new frame has come. Ticks grow by one.
  void Watch(bool has_new_frame) noexcept;
  /// Command in place of `wanted`, for the time since this was last called. Valid until the next
  /// call.
  std::span<const std::int32_t> Command(std::span<const std::int32_t> wanted) noexcept;
  /// The motors follow not faster than the speed of a return for that long, and until they have
  /// caught up.
  void Return(std::int64_t least_ticks) noexcept {
    is_returning_ = true;
    return_ticks_ = least_ticks;
  }
  /// The motors are at these counts, from which the next command begins: they were off.
  void MoveTo(std::span<const double> motor_counts) noexcept;

  Tier tier() const noexcept { return tier_; }

 private:
  bool exists_ = false;
  double hold_ticks_ = 0.0;
  double relax_ticks_ = 0.0;
  double off_ticks_ = 0.0;
  int good_frames_ = 0;
  double return_per_relax_ = 1.0;    // of the two speeds
  std::vector<double> step_counts_;  // per motor and tick, when it relaxes
  std::vector<double> safe_counts_;  // per motor
  std::vector<double> place_counts_;
  std::vector<std::int32_t> command_;
  Tier tier_ = Tier::kFollow;
  bool has_frame_ = false;
  bool is_returning_ = false;
  std::int64_t return_ticks_ = 0;  // to go at least
  int good_ = 0;
  std::int64_t silent_ticks_ = 0;
  std::int64_t ticks_to_go_ = 0;  // since the last command
};

}  // namespace gauntlet::sim
