#include "sim/live/motor_rest.h"

#include <algorithm>
#include <variant>

namespace gauntlet::sim {
namespace {

WatchdogConfig RestOf(const LinksConfig& links) {
  TieredWatchdog tiers;
  if (links.hand) {
    if (const auto* own = std::get_if<TieredWatchdog>(&links.hand->watchdog.settings)) tiers = *own;
  }
  constexpr double kHold_ms = 50.0;
  constexpr double kRelax_ms = 100.0;
  constexpr double kNever_ms = 100'000.0;
  tiers.hold_after_ms = kHold_ms;
  tiers.relax_after_ms = kRelax_ms;
  tiers.off_after_ms = kNever_ms;
  return {.settings = tiers};
}

}  // namespace

MotorRest::MotorRest(const LinksConfig& links, const controller::TendonTransmission& hand,
                     const controller::Timing& timing)
    : watchdog_(RestOf(links), hand, timing),
      event_ticks_(timing.TicksOf(timing.event_period_ms)) {}

void MotorRest::Reset(std::span<const std::int32_t> counts) {
  wanted_.assign(counts.begin(), counts.end());
  watchdog_.Reset(counts);
  watchdog_.Watch(true);
  while (watchdog_.tier() == Watchdog::Tier::kFollow) watchdog_.Watch(false);
  watchdog_.Command(wanted_);
}

std::span<const std::int32_t> MotorRest::Frame(std::int64_t tick,
                                               std::span<const std::int32_t> frame,
                                               bool may_follow) noexcept {
  watchdog_.Watch(may_follow);
  const bool is_resting = watchdog_.tier() != Watchdog::Tier::kFollow;
  if (is_resting && !was_resting_ && !may_follow) ++rests_;
  was_resting_ = is_resting;
  if (!frame.empty()) {
    std::ranges::copy(frame, wanted_.begin());
    has_wanted_ = true;
  }
  const bool is_due =
      has_wanted_ && is_resting && static_cast<double>(tick - sent_tick_) >= event_ticks_;
  if (frame.empty() && !is_due) return {};
  sent_tick_ = tick;
  return watchdog_.Command(wanted_);
}

}  // namespace gauntlet::sim
