#include "sim/trial/link/watchdog.h"

#include <algorithm>
#include <cmath>

#include "controller/angle.h"
#include "controller/assert.h"

namespace gauntlet::sim {

Watchdog::Watchdog(const WatchdogConfig& config, const controller::TendonTransmission& hand,
                   const controller::Timing& timing) {
  controller::CheckSettings(config);
  config.Check();
  const auto* tiers = std::get_if<TieredWatchdog>(&config.settings);
  if (tiers == nullptr) return;
  exists_ = true;
  hold_ticks_ = timing.TicksOf(tiers->hold_after_ms);
  relax_ticks_ = timing.TicksOf(tiers->relax_after_ms);
  off_ticks_ = timing.TicksOf(tiers->off_after_ms);
  good_frames_ = tiers->good_frames;
  return_per_relax_ = tiers->return_deg_s / tiers->relax_deg_s;
  const double step_rad = tiers->relax_deg_s * controller::kRadPerDeg / timing.tick_rate_hz;
  for (std::size_t motor = 0; motor < hand.counts_per_rad.size(); ++motor) {
    step_counts_.push_back(std::abs(hand.counts_per_rad[motor]) * step_rad);
    safe_counts_.push_back(hand.center_counts[motor]);
  }
  place_counts_ = safe_counts_;
  command_.resize(safe_counts_.size());
}

void Watchdog::Reset(std::span<const std::int32_t> motor_counts) {
  tier_ = Tier::kFollow;
  has_frame_ = is_returning_ = false;
  silent_ticks_ = ticks_to_go_ = return_ticks_ = 0;
  if (!exists_) return;
  GAUNTLET_ASSERT(motor_counts.size() == place_counts_.size());
  std::ranges::copy(motor_counts, place_counts_.begin());
  std::ranges::copy(motor_counts, command_.begin());
}

void Watchdog::Watch(bool has_new_frame) noexcept {
  ++ticks_to_go_;
  return_ticks_ = std::max<std::int64_t>(0, return_ticks_ - 1);
  has_frame_ = has_frame_ || has_new_frame;
  if (!exists_ || !has_frame_) return;
  silent_ticks_ = has_new_frame ? 0 : silent_ticks_ + 1;
  const auto silent = static_cast<double>(silent_ticks_);
  if (silent >= hold_ticks_) {
    good_ = 0;
    is_returning_ = true;
    tier_ = silent >= off_ticks_ ? Tier::kOff : silent >= relax_ticks_ ? Tier::kRelax : Tier::kHold;
    return;
  }
  if (tier_ == Tier::kFollow) return;
  if (has_new_frame && ++good_ >= good_frames_) {
    tier_ = Tier::kFollow;
  } else if (has_new_frame) {
    tier_ = Tier::kHold;
  }
}

std::span<const std::int32_t> Watchdog::Command(std::span<const std::int32_t> wanted) noexcept {
  GAUNTLET_ASSERT(exists_ && wanted.size() == place_counts_.size());
  const double speed = tier_ == Tier::kRelax ? 1.0 : return_per_relax_;
  const double steps = speed * static_cast<double>(ticks_to_go_);
  ticks_to_go_ = 0;
  if (tier_ == Tier::kHold || tier_ == Tier::kOff) return command_;
  const bool is_limited = tier_ == Tier::kRelax || is_returning_;
  bool is_there = true;
  for (std::size_t motor = 0; motor < place_counts_.size(); ++motor) {
    const double target = tier_ == Tier::kRelax ? safe_counts_[motor] : wanted[motor];
    double& place = place_counts_[motor];
    const double step = is_limited ? steps * step_counts_[motor] : std::abs(target - place);
    place += std::clamp(target - place, -step, step);
    is_there = is_there && place == target;
    command_[motor] = static_cast<std::int32_t>(std::lround(place));
  }
  if (tier_ == Tier::kFollow && is_there && return_ticks_ == 0) is_returning_ = false;
  return command_;
}

void Watchdog::MoveTo(std::span<const double> motor_counts) noexcept {
  if (!exists_) return;
  for (std::size_t motor = 0; motor < place_counts_.size(); ++motor) {
    place_counts_[motor] = motor_counts[motor];
    command_[motor] = static_cast<std::int32_t>(std::lround(motor_counts[motor]));
  }
}

}  // namespace gauntlet::sim
