#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace gauntlet::sim {

/// A stretch of a recording with known angles of the wearer.
struct KnownPose {
  double start_s = 0.0;           // since the first row of the recording
  double end_s = 0.0;             // infinite: until the end
  std::vector<double> angle_deg;  // one per channel; NaN: unknown
};

/// Known poses in order of time, from a table with a header. Columns: `start_s`; `end_s` (without
/// it a pose lasts until the next begins); `name`, for people; `NAME_deg` or `NAME_rad` per
/// channel, empty where the angle is unknown.
/// Errors: UserError `file:row:column: ...`, also for poses that overlap.
std::vector<KnownPose> LoadPoseTable(const std::filesystem::path& file,
                                     const std::vector<std::string>& channel_names);

}  // namespace gauntlet::sim
