#pragma once

#include <array>
#include <span>
#include <vector>

#include "sim/base/segment.h"
#include "sim/score/counted_ticks.h"

namespace gauntlet::sim {

/// One movement of the wearer in one direction, by at least 5 deg: from where a rest ends or the
/// direction changes to where it changes again or the next rest begins.
struct Movement {
  int begin = 0;
  int end = 0;
  double from_rad = 0.0;
  double to_rad = 0.0;
  bool from_rest = false;
  TickRange within = {};  // the counted ticks around it: a score of the movement looks at no other

  double direction() const { return to_rad > from_rad ? 1.0 : -1.0; }
  double amplitude_rad() const { return (to_rad - from_rad) * direction(); }
};

enum class Regime { kRest, kSlow, kFast, kOnset, kReversal };
inline constexpr int kRegimeCount = 5;

/// Motion of the wearer in one joint.
struct WearerMotion {
  std::vector<Movement> movements;
  std::array<std::vector<TickRange>, kRegimeCount> regimes;

  const std::vector<TickRange>& Of(Regime regime) const {
    return regimes[static_cast<int>(regime)];
  }
};

/// Splits the motion of one joint by its speed (central difference over 10 ms):
///
///     rest      |speed| < 5 deg/s for 0.3 s or more; the first 0.5 s of it belong to no regime,
///               for there the hand still catches up
///     fast      |speed| >= 60 deg/s
///     slow      all else
///     onset     0.3 s from the begin of a movement that starts from rest
///     reversal  0.15 s to both sides of a change of direction between two movements
///
/// Onset and reversal lie within the others. Where `segments` carry these labels they win: rest,
/// slow and fast for the samples they cover, onset and reversal for the whole signal.
///
/// The limits are assumptions: 60 deg/s closes a finger in 1.5 s; 5 deg/s is what an eye still
/// takes for rest. Units: rad. Source: turning points by hysteresis, as in rainflow counting (ASTM
/// E1049).
///
/// Only ticks that count are looked at, and each range of them by itself.
WearerMotion AnalyseWearer(std::span<const double> angle_rad, double rate_hz,
                           std::span<const Segment> segments);
WearerMotion AnalyseWearer(std::span<const double> angle_rad, double rate_hz,
                           std::span<const Segment> segments, const CountedTicks& counted);

}  // namespace gauntlet::sim
