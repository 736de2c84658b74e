#pragma once

#include "sim/live/live_glove.h"

namespace gauntlet::sim {

/// A simulated glove, whose samples are captured at the nominal times of the ticks.
class SimulatedGlove final : public LiveGlove {
 public:
  explicit SimulatedGlove(std::shared_ptr<const GloveSignal> glove);

  bool WaitForFirst() override { return true; }
  std::vector<double> FirstAngles_rad() const override;
  std::int64_t StartTime_ns(std::int64_t soon_ns) const override { return soon_ns; }
  bool HasEnded(std::int64_t tick) const noexcept override;

 private:
  std::span<const std::int32_t> Step(const LiveTick& tick, HandLoop& loop) noexcept override;
  std::optional<SampleTimes> TimesOf(const LiveTick& tick, const HandLoop& loop,
                                     std::int64_t before) const noexcept override;

  std::shared_ptr<const GloveSignal> glove_;
  std::vector<double> counts_;
};

}  // namespace gauntlet::sim
