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
/// - lists in the cells, as LeRobot by pandas: `0,[1.5 2.5],0.1`; `action` becomes `action_1` ..,
///   or `action.wrist` .. where `known` has as many names
/// - a row per channel: turned. A row of zeros in front, of an index, is left out.
/// - JointState as `ros2 topic echo --csv` prints: seconds, nanoseconds, frame, names, numbers, and
///   as `rostopic echo -p`; positions are called `JOINT_rad`
/// - the alpha encoding of opengloves: `A123B456`
///
/// Rows that do not fit become comments. The separator is the comma then.
TextLines::Source PlainTable(TextLines::Source source, const ListNames& known = {});

/// A form of text in which each line is a row.
struct TextForm {
  std::vector<std::string> names;  // of the plain table's columns
  /// The cells of a line in the plain table; none if it does not fit.
  std::function<std::optional<std::vector<std::string>>(std::string_view line)> convert;
  bool has_header = false;  // the first line of the text contains names
};

/// The form of labels, of the alpha encoding, or of JointState, if at least three of these lines
/// (of JointState the first two) and half of them have it.
std::optional<TextForm> LabelledForm(const std::vector<std::string>& head);
std::optional<TextForm> AlphaForm(const std::vector<std::string>& head);
std::optional<TextForm> JointStateForm(const std::vector<std::string>& head);

/// A text that comes line by line.
struct LiveTable {
  TextLines::Source source;
  std::shared_ptr<const std::size_t> left_out = {};  // lines that do not fit; none: not converted
};

/// Plain table of a live stream whose first line has labels or the alpha encoding: its first four
/// lines decide. Any other stream is unchanged after its first line.
LiveTable PlainStream(TextLines::Source source);

}  // namespace gauntlet::sim
