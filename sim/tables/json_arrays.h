#pragma once

#include <string_view>
#include <vector>

#include "sim/tables/array_table.h"
#include "sim/tables/text_forms.h"

namespace gauntlet::sim {

/// The arrays of numbers in a JSON text, or in a text with a JSON value a line. Names are the keys
/// on the way, joined by `_`.
///
///     [[1, 2], [3, 4]]                               columns value_1, value_2
///     {"t": [0, 1], "f": [[1, 2], [3, 4]]}           columns t, f_1, f_2
///     [{"t": 0, "f": {"a": 1, "b": [2, 3]}}, ..]     columns t, f_a, f_b_1, f_b_2
///     {"frames": [{"t": 0}, ..]}                     columns frames_t
///     {"hands": [{"frames": [{"t": 0}, ..]}]}        columns hands_frames_t
///                                                    (of several hands_1_frames_t ..)
///
/// Items of a list that name their hand, left or right, have that name instead of a number:
/// `{"hands": [{"handedness": "Right", "x": 1}]}` is hands_right_x.
///
/// Texts that are numbers, dates or clocks count as such: see SecondsOfText. NaN and infinities
/// without quotes are missing values. Errors: UserError
/// without a place.
std::vector<NamedArray> ReadJsonArrays(std::string_view text);

/// The numbers in one JSON value, each as an array of one row. Names as above; null is kMissing.
/// Errors: UserError without a place.
std::vector<NamedArray> ReadJsonRow(std::string_view text);

/// Facts from LeRobot's info.json about a data set.
struct DatasetInfo {
  ListNames names;        // of the numbers of each feature
  double rate_hz = 0.0;   // frames per second; 0: not known
  double episodes = 0.0;  // that the data set should have; 0: not known
  double rows = 0.0;      // the same
};

/// `{"fps": 30, "total_episodes": 50, "total_frames": 9000, "features": {"action": {"names":
/// ["wrist"]}}}`, or `{"names": {"motors": ["wrist"]}}` in a feature. Empty for other texts.
DatasetInfo ReadDatasetInfo(std::string_view text);

}  // namespace gauntlet::sim
