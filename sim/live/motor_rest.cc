#include "sim/live/motor_rest.h"

#include <algorithm>
#include <cmath>
#include <variant>

namespace gauntlet::sim {
namespace {

constexpr double kHold_ms = 50.0;
constexpr double kReturn_ms = 500.0;  // guard and filter need some samples to believe a jump

/// A gap is longer than some samples, and than the watchdog of a session allows.
std::int64_t LongestGap_ns(const controller::Timing& timing) {
  constexpr double kSamples = 3.0;
  return std::llround(1e6 * std::max(kHold_ms, 1e3 * kSamples / timing.sample_rate_hz()));
}

WatchdogConfig RestOf(const LinksConfig& links) {
  TieredWatchdog tiers;
  if (links.hand) {
    if (const auto* own = std::get_if<TieredWatchdog>(&links.hand->watchdog.settings)) tiers = *own;
  }
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
      event_ticks_(timing.TicksOf(timing.event_period_ms)),
      longest_gap_ns_(LongestGap_ns(timing)),
      return_ticks_(std::llround(timing.TicksOf(kReturn_ms))) {}

void MotorRest::Reset(std::span<const std::int32_t> counts) {
  wanted_.assign(counts.begin(), counts.end());
  watchdog_.Reset(counts);
  watchdog_.Watch(true);
  while (watchdog_.tier() == Watchdog::Tier::kFollow) watchdog_.Watch(false);
  watchdog_.Command(wanted_);
}

void MotorRest::NoteSample(std::int64_t now_ns) noexcept {
  if (sample_ns_ != 0 && now_ns - sample_ns_ > longest_gap_ns_) watchdog_.Return(return_ticks_);
  sample_ns_ = now_ns;
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
