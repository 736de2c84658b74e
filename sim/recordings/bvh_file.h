#pragma once

#include <string>
#include <string_view>

namespace gauntlet::sim {

/// The table of a BVH file: a column `time_s` and the rotations of the bones of its hands relative
/// to the parent joint, as unit quaternions `right_index_middle_local_qw` .. `_qz`, which
/// AnglesOfKeypoints() turns into angles. Joints of digits are found by DigitJointOf(), all others
/// are left out. A hand that lacks a bone or that never moves is left out, if there is another.
///
///     r = R(first channel) R(second channel) R(third channel), in the frame of the parent
///
/// The angles are 0 in the rest pose of the file, which its OFFSETs describe. RemarkLine()s tell
/// how far the fingers bend in it, hands that are left out, and a number of rows other than Frames.
/// A last row that was cut is left out.
///
/// Units: angles of the file in degrees, Frame Time in s.
/// Source: Meredith and Maddock, Motion capture file formats explained, University of Sheffield,
/// CS-01-11, section 2 (Biovision).
/// Errors: UserError `name:line: ..` where the text is no BVH; UserError with `name` if no hand is
/// whole, or its joints may be other ones than their names say.
std::string TableOfBvh(const std::string& name, std::string_view text);

}  // namespace gauntlet::sim
