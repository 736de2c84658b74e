#pragma once

#include <utility>
#include <vector>

#include "sim/base/signal.h"
#include "sim/score/counted_ticks.h"

namespace gauntlet::sim {

/// Fingertips of the hand and of the reference, by the kinematics of the same hand in the frame of
/// its palm [m]. Three columns, x, y and z, for each. Row n is tick n * ticks_per_row. Views.
struct FingertipSignals {
  const Signal* hand_m = nullptr;
  const Signal* reference_m = nullptr;
  int ticks_per_row = 1;
  std::vector<int> measured = {};                 // fingertips that a joint moves that counts
  std::vector<std::pair<int, int>> pinches = {};  // thumb and finger, of which one is measured

  bool exist() const { return hand_m != nullptr; }
};

/// RMS [m] of the distance between the fingertips of hand and reference, over rows whose tick
/// counts and over measured fingertips; kNoScore without any.
double FingertipError(const FingertipSignals& tips, const CountedTicks& counted);

/// RMS [m] of the error of the distance between thumb tip and fingertip:
///
///     |p_thumb - p_finger| of the hand less that of the reference
///
/// over pinches and over rows whose tick counts, where the distance of the reference is below 40
/// mm. kNoScore without any. Tips are the ends of the axes of the last phalanges, so of touching
/// pads 11 to 19 mm are left.
/// Source of the limit: pinches fade out at 40 mm in the retargeting of Wuji Technology (appendix
/// of docs.wuji.tech), and end at 50 mm in DexPilot (arXiv:1910.03135).
double PinchDistanceError(const FingertipSignals& tips, const CountedTicks& counted);

}  // namespace gauntlet::sim
