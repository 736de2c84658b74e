#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace gauntlet::sim {

/// Which ends of a file a stretch of it reaches.
struct StretchEnds {
  bool at_first_row = false;
  bool at_last_row = false;
};

/// Places of the wild values of one joint: what a sensor or its cable said and no hand did.
///
/// One or two values in a row are wild if each lies further than a quarter of the joint's range
/// from the value before and from the value behind them, these two agree within a tenth of the
/// range, and the jumps there and back are faster than 12.5 ranges a second. That is faster than a
/// person who opens and closes a hand by 60 % of the range six times a second, at any row rate.
/// At the first and the last row of a file one neighbour is missing: there the next three values
/// must agree instead.
///
/// Not found: smaller jumps, three and more wild values in a row (they may be a movement), and
/// what a hand can do between two rows: below 50 Hz more than a quarter of the range (0.6 of it at
/// 20 Hz), at 12.5 Hz all of it.
///
/// `range` has the unit of `value`; `time_s` [s] rises strictly. NaN is missing and passed over.
std::vector<std::size_t> FindGlitches(std::span<const double> time_s, std::span<const double> value,
                                      double range, StretchEnds ends);

}  // namespace gauntlet::sim
