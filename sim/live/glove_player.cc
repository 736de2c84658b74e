#include "sim/live/glove_player.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "sim/base/stop.h"
#include "sim/live/device/device_clock.h"
#include "sim/trial/link/transport.h"

namespace gauntlet::sim {

GlovePlayed PlayGlove(const GlovePlay& play, FrameSink& sink) {
  const GloveSignal& glove = *play.glove;
  const LinkConfig link = play.link.value_or(LinkConfig{});
  Transport way(link.transport,
                {.name = "glove",
                 .values = static_cast<int>(glove.channel_names.size()),
                 .period_ticks = static_cast<double>(play.timing.ticks_per_sample)},
                play.timing, play.seed);
  const double tick_ns = 1e9 / play.timing.tick_rate_hz;
  const double length_s = play.seconds > 0.0 ? play.seconds
                                             : static_cast<double>(glove.true_angle_rad.rows()) /
                                                   play.timing.tick_rate_hz;
  const auto ticks = static_cast<std::int64_t>(std::ceil(length_s * play.timing.tick_rate_hz));
  GlovePlayed played;
  std::vector<double> counts(glove.channel_names.size());
  RaisePriority(80);
  constexpr std::int64_t kSoon_ns = 1'000'000;
  const std::int64_t start_ns = MonotonicNow_ns() + kSoon_ns;
  PeriodicWake wake(start_ns, play.timing.tick_rate_hz);
  std::int64_t tick = 0;
  for (; tick < ticks && !StopAsked(); ++tick) {
    const PeriodicWake::Woken woken = wake.Wait();
    played.lateness.Add(woken.lateness_ns);
    played.skipped_ticks += woken.skipped;
    // A device that was late sends what it has, one frame after the other.
    for (std::int64_t end = std::min(tick + woken.skipped, ticks - 1); tick <= end; ++tick) {
      if (tick % play.timing.ticks_per_sample == 0) {
        const Eigen::Index row = (tick / play.timing.ticks_per_sample) % glove.counts.rows();
        for (std::size_t c = 0; c < counts.size(); ++c) {
          counts[c] = glove.counts(row, static_cast<Eigen::Index>(c));
        }
        way.Send(tick, tick, counts);
        ++played.samples;
      }
      way.Deliver(tick, [&](const LinkFrame& frame) {
        const FrameSink::Result sent =
            sink.Send({.number = frame.number,
                       .time_ns = start_ns + std::llround(frame.stamp_ticks * tick_ns),
                       .values = frame.values});
        if (sent == FrameSink::Result::kGone) ++played.failed;
        if (sent == FrameSink::Result::kDropped) ++played.dropped;
      });
    }
    --tick;
  }
  played.lost = way.lost_frames();
  played.duration_s = static_cast<double>(tick) / play.timing.tick_rate_hz;
  return played;
}

}  // namespace gauntlet::sim
