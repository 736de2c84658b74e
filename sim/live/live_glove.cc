#include "sim/live/live_glove.h"

#include "sim/live/device/device_clock.h"
#include "sim/live/device_glove.h"
#include "sim/live/simulated_glove.h"

namespace gauntlet::sim {

std::span<const std::int32_t> LiveGlove::StepController(const LiveTick& tick,
                                                        HandLoop& loop) noexcept {
  const std::span<const std::int32_t> frame = Step(tick, loop);
  if (const auto times = TimesOf(tick, loop, sample_.number)) {
    sample_ = *times;
    sample_.filtered_ns = MonotonicNow_ns();
  }
  return frame;
}

std::unique_ptr<LiveGlove> MakeLiveGlove(const LiveSetup& setup) {
  if (setup.simulated_glove) return std::make_unique<SimulatedGlove>(setup.simulated_glove);
  return std::make_unique<DeviceGlove>(setup);
}

}  // namespace gauntlet::sim
