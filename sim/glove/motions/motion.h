#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sim/base/signal.h"
#include "sim/glove/motions/motion_config.h"

namespace gauntlet::sim {

/// A stretch of the motion with a name (rest, slow, fast, onset, reversal): samples [begin, end).
struct MotionSegment {
  std::string label;
  int begin = 0;
  int end = 0;
};

/// True joint angles of the wearer over time. Channels are all of GloveChannels().
struct Motion {
  Signal angle_rad;  // samples x channels
  std::vector<MotionSegment> segments;
};

/// Pure: same input, same bytes.
/// Errors: UserError for a recording that cannot be read.
Motion SynthesiseMotion(const MotionConfig& config, double rate_hz, std::uint64_t seed);

}  // namespace gauntlet::sim
