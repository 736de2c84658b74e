#pragma once

#include <span>
#include <vector>

namespace gauntlet::sim {

/// Rows [begin, end) of a recording.
struct RowRange {
  std::size_t begin = 0;
  std::size_t end = 0;
};

/// Parts in which a sensor is clipped: further motion of the wearer is unknown.
///
/// That is where the lowest or the highest value of all comes row after row, for 0.1 s or more and
/// in more rows than any other value does: a device that is polled faster than it measures, or
/// that has few steps, repeats all its values. None where there is one value only.
///
/// `time_s` rises strictly. NaN is missing and passed over.
std::vector<RowRange> FindClipped(std::span<const double> time_s, std::span<const double> value);

}  // namespace gauntlet::sim
