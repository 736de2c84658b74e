#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "controller/calibration/still_stretches.h"
#include "sim/base/signal.h"

namespace gauntlet::sim {

/// What a glove said while its wearer held known poses.
///
/// Shapes: samples x channels; `angle_deg` has no columns if the file has no known angles.
struct PoseRecording {
  std::string name;  // of the file, for messages
  std::vector<std::string> channel_names;
  double rate_hz = 1000.0;  // of samples; a trace of a slow glove has rows in between
  double full_scale_counts = 1023.0;
  double settle_ms = 200.0;  // see PoseRecordingFormat
  Signal counts;             // finite
  /// The first sample of each stretch without a gap: rows that miss a count, or a pause.
  std::vector<Eigen::Index> stretch_begins;
  Signal angle_deg;                   // NaN where the pose is not known or not yet settled
  std::size_t rows_left_out = 0;      // a count was missing
  std::size_t rows_beyond_scale = 0;  // left out, too: a count was below 0 or above full scale
  double resolution_counts = 0.0;     // see ResolutionOf
  std::size_t columns_left_out = 0;   // other signals of a trace
  std::vector<std::string> columns_unknown;     // left out, too
  std::vector<controller::StillStretch> still;  // as was said; empty: to be found
};

/// In seconds since the first row.
struct TimeStretch {
  double start_s = 0.0;
  double end_s = 0.0;
};

struct PoseRecordingFormat {
  double rate_hz = 1000.0;              // of a file without a column of time
  double full_scale_counts = 1023.0;    // of the converter, where the map does not say its bits
  std::string array = {};               // of a file with arrays, see ListArrays()
  std::string map = {};                 // column map; empty: columns by their names
  std::string poses = {};               // table of known poses; empty: known angles are columns
  std::vector<TimeStretch> still = {};  // in which the hand is still; empty: they are found
  /// A pose counts from so long after its angle last changed.
  double settle_ms = 200.0;
};

/// Makes the angles of one channel NaN until they have been the same for so many samples. They are
/// rounded to 1e-6 deg, so that a pose that was computed twice is one pose.
void KeepSettledPoses(Eigen::Index settle_samples, Eigen::Ref<Eigen::VectorXd> angle_deg);

/// Reads a table of any format of TableSource. Per channel `NAME_counts`, and `NAME_deg` or
/// `NAME_rad` for its known angle, empty where it is not known; all channels or none have known
/// angles. Time is a column of time (see TimeScaleS), or not there (`k` is passed over). The CSV of
/// a trace is such a table, too: `counts.NAME`, `true_angle_rad.NAME`; its other signals are left
/// out. NAME is any name. With a map, its columns are the counts (or volts) of its channels. Known
/// angles may also be in a table of poses, see LoadPoseTable.
/// Errors: UserError `file:row:column: ...`; a few counts beyond the scale are none, but more than
/// 5 % of the rows with such are.
PoseRecording LoadPoseRecording(const std::filesystem::path& file,
                                const PoseRecordingFormat& format);

}  // namespace gauntlet::sim
