#pragma once

#include <string>
#include <string_view>

#include "sim/tables/table.h"

namespace gauntlet::sim {

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

}  // namespace gauntlet::sim
