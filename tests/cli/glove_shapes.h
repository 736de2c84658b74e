#pragma once

#include <map>
#include <string>
#include <vector>

namespace gauntlet::test {

/// A recording in one of many shapes, by a formula, and the truth about it.
struct GloveShape {
  std::string name;  // kind and number
  std::string text;
  double rate_hz = 0.0;                            // 0: the file does not contain it
  std::string unit = {};                           // as gauntlet inspect names it
  std::map<std::string, std::string> joints = {};  // channel by column: its name or number
  bool is_inverted = false;                        // the angles fall while the joints bend
  std::vector<std::string> options = {};           // of gauntlet inspect
  std::string question = {};  // part of the sentence that must come; empty: may be answered
  bool map_answers = true;    // the question: else no advice names a map
};

/// Shapes of many kinds: positions beside angles, motion sensors, dead sensors, lists in
/// cells, rows per channel, no hand, labels in cells, JointState, other tools, turns and signs,
/// numbers of sensors, several hands or sessions, columns that rise, clocks of some rows.
std::vector<GloveShape> GloveShapes();

}  // namespace gauntlet::test
