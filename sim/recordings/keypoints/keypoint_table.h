#pragma once

#include <string>
#include <string_view>

#include "sim/recordings/keypoints/keypoint_angles.h"
#include "sim/recordings/keypoints/keypoint_layout.h"
#include "sim/tables/csv_reader.h"
#include "sim/tables/table.h"

namespace gauntlet::sim {

/// The table with angles of joints (`index_mcp_deg` ..) instead of keypoints or rotations of bones,
/// and with its other columns; any other table as it is. Of a table with both hands the names begin
/// with `left_` and `right_`. One of them is left out if it has no angles, as a hand that does
/// nothing. Rows without a hand are left out where the table has times, else their values are
/// missing. Remarks are the skeleton, the unit, the residual, the shares of frames that are lost
/// and implausible, and a hand that is left out. Errors: UserError with `name` as of PlaceHand(),
/// or of AnglesOf() for rotations.
TableInput AnglesOfKeypoints(const std::string& name, TableInput input);

/// Findings about a hand, for a person.
std::string RemarkOf(const PlacedHand& hand, const KeypointColumns& columns);

/// The table of a BVH file: a column `time_s` and the rotations of the bones of its hands relative
/// to the parent joint, as unit quaternions `right_index_middle_local_qw` .. `_qz`, which
/// AnglesOfKeypoints() turns into angles. Joints of digits are found by DigitJointOf(), all others
/// are left out. A hand that lacks a bone or that never moves is left out, if there is another.
///
///     r = conj(F of the bone before) R(first channel) R(second channel) R(third channel) F
///
/// F turns the first bone of a digit to this one in the rest pose, as the OFFSETs describe it, step
/// by step: so PIP, DIP and the thumb's angles are 0 where the bones are straight. Those of the MCP
/// of a finger are 0 in the rest pose. The end of a digit counts if it is within 45 deg of the bone
/// before. Remarks are the correction by the OFFSETs, hands that are left out, and a number of rows
/// other than Frames.
/// A last row that was cut is left out.
///
/// Units: angles of the file in degrees, Frame Time in s.
/// Source: Meredith and Maddock, Motion capture file formats explained, University of Sheffield,
/// CS-01-11, section 2 (Biovision).
/// Errors: UserError `name:line: ..` where the text is no BVH; UserError with `name` if no hand is
/// whole, or its joints may be other ones than their names say.
Table TableOfBvh(const std::string& name, std::string_view text);

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
