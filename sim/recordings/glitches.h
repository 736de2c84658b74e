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
/// A run of values is wild that leaves the line between the value before and the value behind it,
/// to one side and back, where these two nearly agree, by more than each of
///
///     0.14 of the joint's range
///     4 times what the joint moves in 95 % of its rows, twice running in one direction
///     8 times its own noise, by the curvature of three rows (both only of 30 values or more)
///
/// and there and back faster than a hand, 14 ranges a second: by jumps at both ends of the run,
/// which lasts up to 12 values or 0.12 s, and no longer than what is good before it; or by a bump,
/// on average. A person who opens and closes a hand by 60 % of the range six times a second stays
/// below, at any row rate. One or two values in a row are also wild if each lies further than a
/// quarter of the range from both neighbours, on either side, by more than 12.5 ranges a second,
/// and these agree within a tenth; so it is at the first and the last row of a file, where the next
/// three values must agree instead.
///
/// Not found: smaller and longer excursions, and what a hand can do between two rows: below 100 Hz
/// more than 0.14 of the range (0.25 of it at 50 Hz, 0.6 at 20 Hz), at 12.5 Hz all of it.
///
/// `range` has the unit of `value`; `time_s` [s] rises strictly. NaN is missing and passed over.
/// Found in real motions at 100 Hz: 98 % of single values of 20 deg, 83 to 96 % of runs of 3 to 6
/// such, 95 % of bumps of 40 deg, and none in 415,000 real samples without one.
std::vector<std::size_t> FindGlitches(std::span<const double> time_s, std::span<const double> value,
                                      double range, StretchEnds ends);

}  // namespace gauntlet::sim
