#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace gauntlet::sim {

/// A stretch of a recording in which the wearer held known angles.
struct KnownPose {
  double start_s = 0.0;           // since the first row of the recording
  double end_s = 0.0;             // infinite: to the end
  std::vector<double> angle_deg;  // one per channel; NaN: not known
};

/// Known poses in the order of time, from a table with a header: `start_s`; `end_s`, or without
/// it a pose lasts until the next begins; `name`, which is for people; and `NAME_deg` or `NAME_rad`
/// for each of the channels, empty where the angle is not known.
/// Errors: UserError `file:row:column: ...`, also for poses that overlap.
std::vector<KnownPose> LoadPoseTable(const std::filesystem::path& file,
                                     const std::vector<std::string>& channel_names);

}  // namespace gauntlet::sim
