#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "sim/base/masked_stretch.h"
#include "sim/score/no_score.h"

namespace gauntlet::sim {

/// Ticks [begin, end).
struct TickRange {
  int begin = 0;
  int end = 0;
};

/// Which ticks of a trial count for the scores of one part of the hand: ranges that rise and do not
/// touch. What the wearer did in all others is not known.
using CountedTicks = std::vector<TickRange>;

/// Counted ticks of all parts of a trial, in the order of the signals' columns.
struct CountedParts {
  std::vector<CountedTicks> joints;
  std::vector<CountedTicks> motors;
  std::vector<CountedTicks> cables;
  CountedTicks hand;  // for what belongs to the hand as a whole
};

/// Counted ticks among 0 .. `ticks` of a part that follows these channels:
///
///     gap      not from its begin until `recovery_ticks` after its end, for filters and hand
///              have held on to what was before and need time to come back
///     restart  not for `recovery_ticks`, likewise
///     clipped  not while it lasts: what the sensor says goes on from its stop, without a jump
CountedTicks CountTicks(std::span<const MaskedStretch> masked, const std::vector<bool>& follows,
                        int recovery_ticks, int ticks);

/// True for rising ranges of the ticks 0 .. `ticks`.
bool AreWithin(const CountedTicks& counted, std::ptrdiff_t ticks);

/// Ticks in both.
CountedTicks Overlap(const std::vector<TickRange>& ranges, const CountedTicks& counted);

/// Counted ticks outside a range.
CountedTicks Without(const CountedTicks& counted, const TickRange& left_out);

/// How many ticks these are.
int CountOf(const CountedTicks& counted);

/// Share of the counted ticks, without the first ones of each range, for which `is_so(tick)`.
template <class IsSo>
double ShareOfTicks(const CountedTicks& counted, const IsSo& is_so, int left_out = 0) {
  int count = 0;
  int so = 0;
  for (const TickRange& range : counted) {
    for (int n = range.begin + left_out; n < range.end; ++n) {
      ++count;
      so += is_so(n) ? 1 : 0;
    }
  }
  return count == 0 ? kNoScore : static_cast<double>(so) / count;
}

}  // namespace gauntlet::sim
