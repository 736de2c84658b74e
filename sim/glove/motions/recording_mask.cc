#include "sim/glove/motions/recording_mask.h"

#include <algorithm>
#include <cmath>

#include "controller/assert.h"
#include "sim/recordings/clipping.h"
#include "sim/recordings/zero_phase.h"

namespace gauntlet::sim {

int PlayedStretch::TickAt(double time_s) const {
  constexpr double kRounding_ticks = 1e-6;
  const double tick = std::ceil((time_s - start_s) * rate_hz - kRounding_ticks);
  return static_cast<int>(std::clamp(tick, 0.0, static_cast<double>(ticks)));
}

void AddGapsAndRestarts(const Recording& recording, int channel, const PlayedStretch& stretch,
                        const std::vector<bool>& in_gap, std::vector<MaskedStretch>& masked) {
  GAUNTLET_ASSERT(in_gap.size() == stretch.ticks);
  auto begin = std::ranges::find(in_gap, true);
  while (begin != in_gap.end()) {
    const auto end = std::find(begin, in_gap.end(), false);
    masked.push_back({.reason = MaskReason::kGap,
                      .channel = channel,
                      .begin = static_cast<int>(begin - in_gap.begin()),
                      .end = static_cast<int>(end - in_gap.begin())});
    begin = std::find(end, in_gap.end(), true);
  }
  for (const double restart_s : recording.restart_s) {
    const int tick = stretch.TickAt(restart_s);
    const bool is_inside = tick > 0 && tick < static_cast<int>(stretch.ticks);
    if (is_inside) masked.push_back({MaskReason::kRestart, channel, tick, tick});
  }
}

void AddClipped(const Recording& recording, int channel, const PlayedStretch& stretch,
                std::vector<MaskedStretch>& masked) {
  const auto angle = recording.angle_rad.col(channel);
  const std::vector<double>& time_s = recording.time_s;
  for (const RowRange& rows : FindClipped(time_s, {angle.data(), time_s.size()})) {
    const bool ends = rows.end < time_s.size();
    const int begin = stretch.TickAt(time_s[rows.begin]);
    const int end = ends ? stretch.TickAt(time_s[rows.end]) : static_cast<int>(stretch.ticks);
    if (begin < end) masked.push_back({MaskReason::kClipped, channel, begin, end});
  }
}

void SmoothBetween(const std::vector<MaskedStretch>& masked, int channel, double cutoff_hz,
                   double rate_hz, std::span<double> angle_rad) {
  std::vector<std::size_t> borders{0, angle_rad.size()};
  for (const MaskedStretch& stretch : masked) {
    if (stretch.channel != channel || stretch.reason == MaskReason::kClipped) continue;
    GAUNTLET_ASSERT(0 <= stretch.begin && stretch.begin <= stretch.end);
    GAUNTLET_ASSERT(stretch.end <= std::ssize(angle_rad));
    borders.push_back(stretch.begin);
    borders.push_back(stretch.end);
  }
  std::ranges::sort(borders);
  for (std::size_t i = 0; i + 1 < borders.size(); ++i) {
    SmoothZeroPhase(cutoff_hz, rate_hz, angle_rad.subspan(borders[i], borders[i + 1] - borders[i]));
  }
}

}  // namespace gauntlet::sim
