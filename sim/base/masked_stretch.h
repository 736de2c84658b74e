#pragma once

#include <array>
#include <string_view>

namespace gauntlet::sim {

/// Reason why a stretch of a recording has no valid data.
enum class MaskReason {
  kGap,      // no rows
  kRestart,  // the clock started anew; the next rows are of another moment
  kClipped,  // the sensor was saturated
};
inline constexpr std::array<std::string_view, 3> kMaskReasonNames = {"gap", "restart", "clipped"};

/// A stretch of one channel without valid data: ticks [begin, end). A restart is empty.
struct MaskedStretch {
  MaskReason reason = MaskReason::kGap;
  int channel = 0;
  int begin = 0;
  int end = 0;
};

}  // namespace gauntlet::sim
