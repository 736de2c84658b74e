#pragma once

#include <string>

#include "sim/recordings/keypoints/keypoint_angles.h"
#include "sim/recordings/keypoints/keypoint_layout.h"
#include "sim/tables/csv_reader.h"

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

}  // namespace gauntlet::sim
