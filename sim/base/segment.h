#pragma once

#include <string>

namespace gauntlet::sim {

/// A labelled stretch of the wearer's motion: samples [begin, end).
///
/// A label rest, slow, fast, onset or reversal decides how the stretch is scored; it overrides each
/// joint's own speed. Any other label is only stored.
struct Segment {
  std::string label;
  int begin = 0;
  int end = 0;
};

}  // namespace gauntlet::sim
