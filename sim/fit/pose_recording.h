#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "controller/calibration/still_stretches.h"
#include "controller/sample_guard_config.h"
#include "sim/base/signal.h"

namespace gauntlet::sim {

/// Counts of a glove while its wearer holds known poses.
///
/// Shapes: samples x channels; `angle_deg` has no columns if the file has no known angles.
struct PoseRecording {
  std::string name;  // of the file, for messages
  std::vector<std::string> channel_names;
  double rate_hz = 1000.0;  // of samples; a trace of a slow glove has more rows
  /// One for all channels, or one for each.
  std::vector<controller::ConverterRange> converters = {controller::ConverterRange{}};
  double settle_ms = 200.0;  // see PoseRecordingFormat
  Signal counts;             // finite
  /// First sample of each stretch without a gap. A gap is a pause, or rows without a count.
  std::vector<Eigen::Index> stretch_begins;
  Signal angle_deg;                          // NaN if unknown or not settled
  std::size_t rows_left_out = 0;             // rows without a count
  std::size_t rows_beyond_scale = 0;         // ignored too: a count outside the converter's range
  double resolution_counts = 0.0;            // see ResolutionOf
  std::vector<std::string> columns_unknown;  // ignored too
  std::vector<controller::StillStretch> still;  // given by the user; empty: to be found

  const controller::ConverterRange& converter(std::size_t channel) const {
    return converters[converters.size() == 1 ? 0 : channel];
  }
};

/// Time interval in seconds since the first row.
struct TimeStretch {
  double start_s = 0.0;
  double end_s = 0.0;
};

struct PoseRecordingFormat {
  double rate_hz = 1000.0;  // of a file without a time column
  // Of the converter, one for all channels or one for each. Where the map has bits, they decide the
  // largest value.
  std::vector<double> full_scale_counts = {1023.0};
  std::vector<double> min_counts = {0.0};
  std::string array = {};      // of a file with arrays, see ListArrays()
  std::string map = {};        // column map; empty: columns by their names
  std::string unit = {};       // of NAME alone: counts, volts, deg or rad; empty: it is unknown
  std::string time_unit = {};  // of a column of numbers; empty: found, see TimeByName()
  std::string poses = {};      // table of known poses; empty: angles are columns
  std::vector<TimeStretch> still = {};  // the hand is still; empty: to be found
  /// Time from the last change of an angle until the pose counts.
  double settle_ms = 200.0;
};

/// Sets the angles of one channel to NaN until they have been constant for this number of samples.
/// Rounds them to 1e-6 deg, so that a pose that was computed twice is one pose.
void KeepSettledPoses(Eigen::Index settle_samples, Eigen::Ref<Eigen::VectorXd> angle_deg);

/// Reads a table of any format of TableSource. Each channel has a column `NAME_counts`, with any
/// NAME, and `NAME_deg` or `NAME_rad` with its known angle, empty where unknown. All channels have
/// known angles, or none has. A time column (see TimeScaleS) is optional; a column `k` is ignored.
/// The CSV of a trace is also accepted: `counts.NAME`, `true_angle_rad.NAME`; its other signals are
/// ignored. With a map, its columns are the counts (or volts) of its channels. Known angles may
/// also be in a pose table, see LoadPoseTable.
/// Errors: UserError `file:row:column: ...`. Rows with counts beyond the scale are ignored; more
/// than 5 % of them are an error.
PoseRecording LoadPoseRecording(const std::filesystem::path& file,
                                const PoseRecordingFormat& format);

/// Quantisation step of the values: 1 for counts, the volts of one count for volts, 0 without
/// quantisation.
///
/// The step of a channel is the smallest distance between two different values. Conditions: eight
/// different values or more; half of the neighbouring values are one step apart; distances up to
/// five steps are multiples of it, with a tolerance of a quarter step, because the text of volts is
/// rounded again. The result is the smallest step of the channels that meet them. If none does, it
/// is 1 for whole numbers.
/// Shapes: samples x channels, finite.
double ResolutionOf(const Signal& values);

}  // namespace gauntlet::sim
