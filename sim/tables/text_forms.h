#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/tables/text_lines.h"

namespace gauntlet::sim {

/// Names of the numbers of a list, by the column of the list.
using ListNames = std::map<std::string, std::vector<std::string>>;

/// A table of one value per cell from texts in other forms; all other texts as they are:
///
/// - labels in the cells, as the serial plotter of Arduino: `10:15:00.0 -> Thumb:300 Index:4`
/// - rows behind a clock, as the serial monitor of Arduino: `10:15:00.0 -> 300,4`, or both behind
///   the milliseconds of a log of ESP-IDF: `I (1020) GLOVE: Thumb=300`
/// - lists in the cells, as LeRobot by pandas: `0,[1.5 2.5],0.1`; `action` becomes `action_1` ..,
///   or `action.wrist` .. where `known` has as many names
/// - a row per channel: turned. A row of zeros in front, of an index, is left out.
/// - JointState as `ros2 topic echo --csv` prints: seconds, nanoseconds, frame, names, numbers, and
///   as `rostopic echo -p`; positions are called `JOINT_rad`
/// - the alpha encoding of opengloves: `A123B456`
///
/// Rows that do not fit become comments. The separator is the comma then.
TextLines::Source PlainTable(TextLines::Source source, const ListNames& known = {});

enum class TextFormKind { kLists, kLabels, kClocked, kAlpha, kJointState };

/// A form of text in which each line is a row.
struct TextForm {
  TextFormKind kind = TextFormKind::kLists;
  std::vector<std::string> names = {};  // of the plain table's columns
  /// The cells of a line in the plain table; none if it does not fit.
  std::function<std::optional<std::vector<std::string>>(std::string_view line)> convert = {};
  bool has_header = false;  // the first line of the text contains names
};

/// The form of a text that begins with these lines. Labels, clocks and the alpha encoding need
/// three of them and half of them, all other forms the first two.
std::optional<TextForm> FormOf(const std::vector<std::string>& head, const ListNames& known = {});

/// A text that comes line by line.
struct LiveTable {
  TextLines::Source source;
  std::shared_ptr<const std::size_t> left_out = {};  // lines that do not fit; none: not converted
};

/// Plain table of a live stream. Its first two lines decide, or four if the first one has labels, a
/// clock or the alpha encoding; a first line of numbers alone is a row. `name` stands for it in
/// messages.
LiveTable PlainStream(const std::string& name, TextLines::Source source);

}  // namespace gauntlet::sim
