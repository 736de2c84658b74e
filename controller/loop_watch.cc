#include "controller/loop_watch.h"

#include <algorithm>
#include <cmath>

namespace gauntlet::controller {

void LoopWatch::TakeElapsedTime(double elapsed_ms) noexcept {
  if (elapsed_ms > 0.0 && std::isfinite(elapsed_ms)) elapsed_ms_ = elapsed_ms;
}

LoopStatus LoopWatch::Tick() noexcept {
  if (elapsed_ms_ == 0.0) return is_wrong_ ? LoopStatus::kWrongRate : LoopStatus::kInTime;
  constexpr std::int64_t kWindow = 256;
  constexpr double kOff = 0.05;
  constexpr double kLate = 0.5;
  const double ticks = elapsed_ms_ / tick_ms_;
  const bool is_overrun = ticks >= 1.0 + kLate;
  overruns_ += is_overrun ? 1 : 0;
  too_long_ += ticks > 1.0 + kOff ? 1 : 0;
  too_short_ += ticks < 1.0 - kOff ? 1 : 0;
  sum_ms_ += elapsed_ms_;
  elapsed_ms_ = 0.0;
  if (++steps_ == kWindow) EndWindow();
  if (is_wrong_) return LoopStatus::kWrongRate;
  return is_overrun ? LoopStatus::kOverrun : LoopStatus::kInTime;
}

void LoopWatch::EndWindow() noexcept {
  is_wrong_ = 2 * std::max(too_long_, too_short_) > steps_;
  measured_rate_hz_ = 1e3 * static_cast<double>(steps_) / sum_ms_;
  steps_ = 0;
  too_long_ = 0;
  too_short_ = 0;
  sum_ms_ = 0.0;
}

}  // namespace gauntlet::controller
