#pragma once

#include <string>

namespace gauntlet::sim {

/// A stretch of the wearer's motion that a person gave a name: samples [begin, end).
///
/// The label rest, slow, fast, onset or reversal says under what the stretch is scored, in place of
/// each joint's own speed; any other name is only stored.
struct Segment {
  std::string label;
  int begin = 0;
  int end = 0;
};

}  // namespace gauntlet::sim
