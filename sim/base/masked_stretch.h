#pragma once

#include <array>
#include <string_view>

namespace gauntlet::sim {

/// Why a stretch of a recording says nothing of what the wearer did.
enum class MaskReason {
  kGap,      // nothing was recorded
  kRestart,  // the clock started anew: what follows is of another moment
  kClipped,  // the sensor stood at its stop
};
inline constexpr std::array<std::string_view, 3> kMaskReasonNames = {"gap", "restart", "clipped"};

/// Such a stretch of one channel: ticks [begin, end); a restart is a moment, and empty.
struct MaskedStretch {
  MaskReason reason = MaskReason::kGap;
  int channel = 0;
  int begin = 0;
  int end = 0;
};

}  // namespace gauntlet::sim
