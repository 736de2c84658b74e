#include "sim/score/counted_ticks.h"

#include <algorithm>

#include "controller/assert.h"

namespace gauntlet::sim {

CountedTicks CountTicks(std::span<const MaskedStretch> masked, const std::vector<bool>& follows,
                        int recovery_ticks, int ticks) {
  GAUNTLET_ASSERT(recovery_ticks >= 0 && ticks >= 0);
  std::vector<TickRange> left_out;
  for (const MaskedStretch& stretch : masked) {
    GAUNTLET_ASSERT(0 <= stretch.channel && stretch.channel < std::ssize(follows));
    GAUNTLET_ASSERT(0 <= stretch.begin && stretch.begin <= stretch.end && stretch.end <= ticks);
    if (!follows[static_cast<std::size_t>(stretch.channel)]) continue;
    const int recovery = stretch.reason == MaskReason::kClipped ? 0 : recovery_ticks;
    left_out.push_back({stretch.begin, std::min(ticks, stretch.end + recovery)});
  }
  std::ranges::sort(left_out, {}, &TickRange::begin);
  CountedTicks counted;
  int begin = 0;
  for (const TickRange& range : left_out) {
    if (range.begin > begin) counted.push_back({begin, std::min(ticks, range.begin)});
    begin = std::max(begin, range.end);
  }
  if (begin < ticks) counted.push_back({begin, ticks});
  return counted;
}

bool AreWithin(const CountedTicks& counted, std::ptrdiff_t ticks) {
  int end = 0;
  return std::ranges::all_of(counted, [&](const TickRange& range) {
    const bool rises = end <= range.begin && range.begin <= range.end && range.end <= ticks;
    end = range.end;
    return rises;
  });
}

CountedTicks Overlap(const std::vector<TickRange>& ranges, const CountedTicks& counted) {
  CountedTicks overlap;
  for (const TickRange& range : ranges) {
    for (const TickRange& other : counted) {
      const TickRange both{std::max(range.begin, other.begin), std::min(range.end, other.end)};
      if (both.begin < both.end) overlap.push_back(both);
    }
  }
  return overlap;
}

CountedTicks Without(const CountedTicks& counted, const TickRange& left_out) {
  CountedTicks rest;
  for (const TickRange& range : counted) {
    const TickRange before{range.begin, std::min(range.end, left_out.begin)};
    const TickRange behind{std::max(range.begin, left_out.end), range.end};
    for (const TickRange& part : {before, behind}) {
      if (part.begin < part.end) rest.push_back(part);
    }
  }
  return rest;
}

int CountOf(const CountedTicks& counted) {
  int count = 0;
  for (const TickRange& range : counted) count += range.end - range.begin;
  return count;
}

}  // namespace gauntlet::sim
