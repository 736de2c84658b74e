#include "controller/loop_watch.h"

#include <cmath>

namespace gauntlet::controller {
namespace {

constexpr double kOff = 0.05;  // share of a tick

}  // namespace

void LoopWatch::TakeElapsedTime(double elapsed_ms) noexcept {
  if (elapsed_ms > 0.0 && std::isfinite(elapsed_ms)) elapsed_ms_ = elapsed_ms;
}

LoopStatus LoopWatch::Tick() noexcept {
  if (elapsed_ms_ == 0.0) return is_wrong_ ? LoopStatus::kWrongRate : LoopStatus::kInTime;
  constexpr std::int64_t kWindow = 256;
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
  // A single long stall moves the mean alone, jitter that is not symmetric the median alone.
  const double ticks = sum_ms_ / (static_cast<double>(steps_) * tick_ms_);
  is_wrong_ = (2 * too_long_ > steps_ && ticks > 1.0 + kOff) ||
              (2 * too_short_ > steps_ && ticks < 1.0 - kOff);
  measured_rate_hz_ = 1e3 * static_cast<double>(steps_) / sum_ms_;
  steps_ = 0;
  too_long_ = 0;
  too_short_ = 0;
  sum_ms_ = 0.0;
}

}  // namespace gauntlet::controller
