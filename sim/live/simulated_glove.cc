#include "sim/live/simulated_glove.h"

#include <utility>

namespace gauntlet::sim {

SimulatedGlove::SimulatedGlove(std::shared_ptr<const GloveSignal> glove)
    : glove_(std::move(glove)), counts_(static_cast<std::size_t>(glove_->counts.cols())) {}

std::vector<double> SimulatedGlove::FirstAngles_rad() const {
  std::vector<double> angles_rad;
  for (Eigen::Index c = 0; c < glove_->true_angle_rad.cols(); ++c) {
    angles_rad.push_back(glove_->true_angle_rad(0, c));
  }
  return angles_rad;
}

bool SimulatedGlove::HasEnded(std::int64_t tick) const noexcept {
  return tick >= glove_->true_angle_rad.rows();
}

std::span<const std::int32_t> SimulatedGlove::Step(const LiveTick& /*tick*/,
                                                   HandLoop& loop) noexcept {
  const std::int64_t tick = loop.tick();
  if (HasEnded(tick) || tick % glove_->ticks_per_sample != 0) return loop.StepController();
  const Eigen::Index sample = tick / glove_->ticks_per_sample;
  for (std::size_t c = 0; c < counts_.size(); ++c) {
    counts_[c] = glove_->counts(sample, static_cast<Eigen::Index>(c));
  }
  return loop.StepController({.counts = counts_});
}

std::optional<SampleTimes> SimulatedGlove::TimesOf(const LiveTick& tick, const HandLoop& loop,
                                                   std::int64_t before) const noexcept {
  const std::int64_t captured = loop.sample_tick();
  if (loop.taken_counts().empty() || captured == before) return std::nullopt;
  const std::int64_t capture_ns = tick.wake.NominalOf_ns(captured);
  return SampleTimes{.number = captured,
                     .arrival_ns = capture_ns,
                     .decoded_ns = capture_ns,
                     .taken_ns = loop.glove_receiver() == nullptr ? tick.woken_ns : capture_ns,
                     .used_ns = tick.woken_ns};
}

}  // namespace gauntlet::sim
