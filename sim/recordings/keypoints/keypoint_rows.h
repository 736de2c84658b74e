#pragma once

#include <string>

#include "sim/tables/csv_reader.h"

namespace gauntlet::sim {

/// Keypoints of a frame in one row, from a table in which each has a row, or from a text in which
/// each hand has a line; any other input as it is.
///
/// - a row per keypoint: columns x, y, z and one that names or numbers the keypoint (`landmark`,
///   `joint` ..), with a time or the number of the frame; a column of the hand (`hand`, `side` ..)
///   becomes a part of the names; without x, y and z also a quaternion (`qw`, `rotation_w` ..)
/// - lines of Hand Tracking Streamer, `Right landmarks:, x, y, z, ..` of 21 points; `t` in
///   `Right landmarks | f = 1 | t = 5:` is the time in ns. The wrist's line is left out, as the
///   points are relative to the wrist.
///
/// Source: wengmister/hand-tracking-streamer, CONNECTIONS.md.
/// Errors: UserError for a text with a row per keypoint that has more than 333 keypoints or ten
/// million values.
TableInput KeypointsInColumns(const std::string& name, TableInput input);

}  // namespace gauntlet::sim
