#pragma once

#include <map>
#include <string>
#include <string_view>

namespace gauntlet::sim {

/// Types of joints in a URDF by name, as `revolute`; empty for a text without joints.
using JointTypes = std::map<std::string, std::string, std::less<>>;
JointTypes JointTypesIn(std::string_view urdf);

/// Unit of the positions of a joint in messages of JointState, as a suffix of its column, and the
/// evidence for it. ROS defines radians, and metres for joints that slide, but the message does not
/// tell which joints do.
struct JointUnit {
  std::string_view suffix;  // _rad, _m, or nothing: unknown
  std::string why = {};     // for a person; empty for radians as usual
};

/// `largest`: largest magnitude in the whole file; NaN: not known. The first rule that holds:
///
/// | evidence                                                                | unit    |
/// |-------------------------------------------------------------------------|---------|
/// | the name ends with _rad, _deg, _m or _mm                                | that    |
/// | the type of the joint is prismatic, revolute or continuous              | m, rad  |
/// | the name is that of a gripper or slide                                  | unknown |
/// | a value is beyond a turn, and the name is not that of a wheel           | unknown |
/// | any other                                                               | rad     |
///
/// Sources: docs.ros.org, sensor_msgs/JointState; wiki.ros.org/urdf/XML/joint.
JointUnit UnitOfJoint(std::string_view name, double largest, const JointTypes& types);

}  // namespace gauntlet::sim
