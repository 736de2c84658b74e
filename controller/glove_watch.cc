#include "controller/glove_watch.h"

#include <algorithm>
#include <utility>

namespace gauntlet::controller {

GloveWatch::GloveWatch(const SampleGuardConfig& config, const Timing& timing, int channel_count)
    : lost_ticks_(config.lost_after_ms > 0.0 ? timing.TicksOf(config.lost_after_ms)
                                             : std::numeric_limits<double>::infinity()),
      ticks_per_sample_(timing.ticks_per_sample),
      trusted_tick_(static_cast<std::size_t>(channel_count)) {}

bool GloveWatch::Tick(bool has_sample) noexcept {
  ++tick_;
  if (!has_sample) {
    if (tick_ < overdue_tick_) return false;
    overdue_tick_ += ticks_per_sample_;
    return true;
  }
  overdue_tick_ = tick_ + ticks_per_sample_ + ticks_per_sample_ / 2;
  constexpr std::int64_t kWindow = 64;
  if (++window_samples_ > kWindow) {
    too_often_ = 4 * (tick_ - window_tick_) < 3 * kWindow * ticks_per_sample_;
    window_samples_ = 1;
  }
  if (window_samples_ == 1) window_tick_ = tick_;
  return false;
}

void GloveWatch::ReadResults(const SampleGuard& guard) noexcept {
  if (guard.all_trusted()) {
    all_trusted_tick_ = tick_;
    return;
  }
  for (std::size_t i = 0; i < trusted_tick_.size(); ++i) {
    if (guard.trusted(i)) trusted_tick_[i] = tick_;
  }
}

void GloveWatch::Reset() noexcept {
  tick_ = -1;
  overdue_tick_ = 0;
  window_tick_ = 0;
  window_samples_ = 0;
  too_often_ = false;
  all_trusted_tick_ = 0;
  std::fill(trusted_tick_.begin(), trusted_tick_.end(), 0);
}

void GloveWatch::SwapMemory(GloveWatch& from) noexcept {
  std::swap(tick_, from.tick_);
  std::swap(overdue_tick_, from.overdue_tick_);
  std::swap(window_tick_, from.window_tick_);
  std::swap(window_samples_, from.window_samples_);
  std::swap(too_often_, from.too_often_);
  std::swap(all_trusted_tick_, from.all_trusted_tick_);
  trusted_tick_.swap(from.trusted_tick_);
}

}  // namespace gauntlet::controller
