#include "sim/fit/pose_recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "controller/calibration/robust_statistics.h"
#include "sim/base/error.h"
#include "sim/base/nearest_name.h"
#include "sim/base/signal.h"
#include "sim/base/text.h"
#include "sim/fit/pose_columns.h"
#include "sim/recordings/table_source.h"
#include "sim/recordings/time_guess.h"
#include "sim/tables/csv_reader.h"
#include "sim/tables/missing.h"

namespace gauntlet::sim {
namespace {

/// A stretch of a recording with known angles of the wearer.
struct KnownPose {
  double start_s = 0.0;           // since the first row of the recording
  double end_s = 0.0;             // infinite: until the end
  std::vector<double> angle_deg;  // one per channel; NaN: unknown
};

constexpr double kToTheEnd = std::numeric_limits<double>::infinity();

struct AngleColumn {
  std::size_t column = 0;
  double deg_per_unit = 1.0;
};

struct PoseTableColumns {
  std::optional<std::size_t> start;
  std::optional<std::size_t> end;
  std::vector<std::optional<AngleColumn>> angles;  // one per channel
};

/// Adds a column such as `index_mcp_deg` as the angle of its channel. False for any other name.
bool AddAngle(const std::string& name, std::size_t column,
              const std::vector<std::string>& channel_names, PoseTableColumns& columns) {
  const std::size_t cut = std::min(name.rfind('_'), name.size());
  const std::string unit = name.substr(cut);
  const auto channel = std::ranges::find(channel_names, name.substr(0, cut));
  if ((unit != "_deg" && unit != "_rad") || channel == channel_names.end()) return false;
  std::optional<AngleColumn>& angle = columns.angles[channel - channel_names.begin()];
  if (angle) return false;
  angle = {.column = column, .deg_per_unit = unit == "_deg" ? 1.0 : kDegPerRad};
  return true;
}

PoseTableColumns FindTableColumns(CsvReader& csv, const std::vector<std::string>& channel_names) {
  PoseTableColumns columns;
  columns.angles.resize(channel_names.size());
  std::vector<std::string> known = {"name", "start_s", "end_s"};
  for (const std::string& channel : channel_names) known.push_back(channel + "_deg");
  for (std::size_t column = 0; column < csv.header().size(); ++column) {
    const std::string& name = csv.header()[column];
    if (name == "start_s") {
      columns.start = column;
    } else if (name == "end_s") {
      columns.end = column;
    } else if (name == "name") {
      csv.Ignore(column);
    } else if (!AddAngle(name, column, channel_names, columns)) {
      csv.Fail(column + 1,
               fmt::format("{} is no column of a table of poses: name, start_s, end_s, "
                           "or once per channel of the recording NAME_deg or NAME_rad{}",
                           csv.Quoted(name), Suggestion(name, known)));
    }
  }
  if (!columns.start) csv.Fail(1, "there is no column start_s");
  for (std::size_t i = 0; i < channel_names.size(); ++i) {
    if (columns.angles[i]) continue;
    csv.Fail(1, fmt::format("there is no column {}_deg, the recording has this channel",
                            channel_names[i]));
  }
  return columns;
}

/// Known poses in order of time, from a table with a header. Columns: `start_s`; `end_s` (without
/// it a pose lasts until the next begins); `name`, for people; `NAME_deg` or `NAME_rad` per
/// channel, empty where the angle is unknown.
/// Errors: UserError `file:row:column: ...`, also for poses that overlap.
std::vector<KnownPose> LoadPoseTable(const std::filesystem::path& file,
                                     const std::vector<std::string>& channel_names) {
  CsvReader csv(file.string(), FileSource(file), ProblemHandling::kAllowMissing);
  const PoseTableColumns columns = FindTableColumns(csv, channel_names);
  std::vector<KnownPose> poses;
  std::vector<double> values(csv.column_count());
  while (csv.NextRow(values)) {
    KnownPose pose{.start_s = values[*columns.start], .end_s = kToTheEnd, .angle_deg = {}};
    if (!(pose.start_s >= 0.0)) {
      csv.Fail(*columns.start + 1, "must be given, in seconds from the recording's first row");
    }
    if (columns.end && !std::isnan(values[*columns.end])) pose.end_s = values[*columns.end];
    if (!(pose.end_s > pose.start_s)) {
      csv.Fail(*columns.end + 1, fmt::format("the pose ends at {} s, must end behind its start "
                                             "at {} s",
                                             pose.end_s, pose.start_s));
    }
    if (!poses.empty()) {
      KnownPose& before = poses.back();
      if (std::isinf(before.end_s) && before.start_s < pose.start_s) before.end_s = pose.start_s;
      if (before.end_s > pose.start_s) {
        csv.Fail(
            *columns.start + 1,
            fmt::format("the pose begins at {} s, must begin behind the one before", pose.start_s));
      }
    }
    for (const std::optional<AngleColumn>& angle : columns.angles) {
      pose.angle_deg.push_back(values[angle->column] * angle->deg_per_unit);
    }
    poses.push_back(std::move(pose));
  }
  if (poses.empty()) csv.Fail(1, "there is no pose");
  return poses;
}

constexpr std::size_t kFewestRows = 10;

/// Counts outside the converter's range: glitches of the line, or a wrong full scale.
struct BeyondScale {
  std::size_t rows = 0;
  // The first of them.
  std::size_t row = 0;
  std::size_t column = 0;
  double counts = 0.0;
  controller::ConverterRange converter = {};
};

/// The rows of the file, with the times of the first and last row.
struct Rows {
  std::vector<double> counts;
  std::vector<double> angle_deg;
  double first_s = kMissing;
  double last_s = kMissing;
  std::vector<double> time_s;          // of rows with counts, since the first row
  std::size_t count = 0;               // of rows with counts
  std::size_t count_in_file = 0;       // of all rows
  std::vector<std::size_t> distances;  // rows of the file between two rows with counts
  BeyondScale beyond_scale;
  MidnightClock midnight;
};

/// Rows of the file per sample. A trace of a slow glove has rows between samples.
std::size_t RowsPerSample(std::vector<std::size_t> distances) {
  if (distances.empty()) return 1;
  return controller::MedianOf(std::move(distances));
}

/// Finds the beginnings of stretches without gaps, and the sampling rate within them.
void FindStretches(const Rows& rows, bool has_time, PoseRecording& recording) {
  constexpr double kGap = 1.5;  // times the median distance, in rows and in time
  const std::vector<double> distances(rows.distances.begin(), rows.distances.end());
  std::vector<double> steps_s;
  for (std::size_t k = 1; k < rows.time_s.size(); ++k) {
    steps_s.push_back(rows.time_s[k] - rows.time_s[k - 1]);
  }
  const double usual_rows = controller::MedianOf(distances);
  const double usual_s = controller::MedianOf(steps_s);
  recording.stretch_begins = {0};
  double gaps_s = 0.0;
  for (std::size_t k = 0; k < steps_s.size(); ++k) {
    if (distances[k] <= kGap * usual_rows && steps_s[k] <= kGap * usual_s) continue;
    recording.stretch_begins.push_back(static_cast<Eigen::Index>(k + 1));
    gaps_s += steps_s[k];
  }
  if (!has_time) return;
  const std::size_t together = rows.count - recording.stretch_begins.size();
  recording.rate_hz = static_cast<double>(together) / (rows.time_s.back() - gaps_s);
  constexpr double kHighest_hz = 1e6;
  if (!(recording.rate_hz > 0.0 && recording.rate_hz <= kHighest_hz)) {
    throw UserError({.place = recording.name,
                     .problem = fmt::format("the times give {:.5g} samples per second, must be at "
                                            "most {:g}",
                                            recording.rate_hz, kHighest_hz)});
  }
}

void ReadTime(const CsvReader& csv, const PoseColumns& columns, const std::vector<double>& values,
              Rows& rows) {
  if (columns.time.empty()) return;
  const double time_s = rows.midnight.Add(TimeOfRow(columns.time, values));
  const std::size_t place = columns.time.front().column + 1;
  if (std::isnan(time_s)) csv.Fail(place, "the time is missing");
  if (time_s <= rows.last_s) {
    csv.Fail(place, fmt::format("the time is {} s, must be above the {} s of the row before",
                                time_s, rows.last_s));
  }
  if (std::isnan(rows.first_s)) rows.first_s = time_s;
  rows.last_s = time_s;
}

bool IsBeyondScale(const CsvReader& csv, const PoseColumns& columns,
                   const std::vector<double>& values, const PoseRecording& recording, Rows& rows) {
  for (std::size_t i = 0; i < columns.counts.size(); ++i) {
    const std::size_t column = columns.counts[i].column;
    if (recording.converter(i).Contains(values[column])) continue;
    if (rows.beyond_scale.rows++ == 0) {
      rows.beyond_scale = {.rows = 1,
                           .row = csv.row(),
                           .column = column,
                           .counts = values[column],
                           .converter = recording.converter(i)};
    }
    return true;
  }
  return false;
}

/// Refuses the recording if too many rows are outside the range. A few are glitches.
void RejectAnotherScale(const CsvReader& csv, const Rows& rows) {
  constexpr double kMostShare = 0.05;
  const BeyondScale& beyond = rows.beyond_scale;
  if (static_cast<double>(beyond.rows) <=
      kMostShare * static_cast<double>(beyond.rows + rows.count)) {
    return;
  }
  csv.FailInRow(
      beyond.row, beyond.column + 1,
      fmt::format("is {} counts, must be from {} to the converter's full scale of {} "
                  "({}); {} of {} rows have such values",
                  beyond.counts, beyond.converter.min_counts, beyond.converter.full_scale_counts,
                  beyond.counts < beyond.converter.min_counts ? "--min-counts" : "--full-scale",
                  beyond.rows, beyond.rows + rows.count));
}

/// Errors: UserError for times that do not rise, too few rows, or another scale of the counts.
Rows ReadRows(CsvReader& csv, const PoseColumns& columns, double rate_hz,
              const PoseRecording& recording) {
  Rows rows;
  rows.midnight = MidnightClock(columns.time);
  std::size_t last_whole = 0;  // newest row with all counts
  std::vector<double> values(csv.column_count());
  for (; csv.NextRow(values); ++rows.count_in_file) {
    const std::size_t row = rows.count_in_file;
    ReadTime(csv, columns, values, rows);
    const bool whole = std::ranges::none_of(
        columns.counts, [&](const ChannelColumn& c) { return std::isnan(values[c.column]); });
    if (!whole || IsBeyondScale(csv, columns, values, recording, rows)) continue;
    if (rows.count++ > 0) rows.distances.push_back(row - last_whole);
    last_whole = row;
    rows.time_s.push_back(columns.time.empty() ? row / rate_hz : rows.last_s - rows.first_s);
    for (const ChannelColumn& c : columns.counts) rows.counts.push_back(values[c.column]);
    for (const ChannelColumn& c : columns.angles) {
      rows.angle_deg.push_back(values[c.column] * c.scale);
    }
  }
  RejectAnotherScale(csv, rows);
  if (rows.count < kFewestRows) {
    csv.Fail(1,
             fmt::format("the recording has {} rows without missing counts, must have at least {}",
                         rows.count, kFewestRows));
  }
  return rows;
}

/// The value of an option for each of `count` channels. Errors: UserError for another number.
std::vector<double> OfEach(const char* option, const std::vector<double>& values,
                           std::size_t count) {
  if (values.size() == 1) return std::vector(count, values[0]);
  if (values.size() == count) return values;
  throw UserError({.place = option,
                   .problem = fmt::format("has {} values, must have 1 for all channels or {}, one "
                                          "for each column of counts",
                                          values.size(), count)});
}

/// The converter of each column of counts. Errors: UserError for an empty range.
std::vector<controller::ConverterRange> ConvertersIn(const PoseColumns& columns,
                                                     const PoseRecordingFormat& format) {
  const std::size_t count = columns.counts.size();
  const std::vector<double> least = OfEach("--min-counts", format.min_counts, count);
  const std::vector<double> most = OfEach("--full-scale", format.full_scale_counts, count);
  std::vector<controller::ConverterRange> converters;
  for (std::size_t i = 0; i < count; ++i) {
    const int bits = columns.counts[i].bits;
    converters.push_back(
        {.min_counts = least[i],
         .full_scale_counts = bits > 0 ? least[i] + std::ldexp(1.0, bits) - 1.0 : most[i]});
    if (converters[i].span_counts() > 0.0) continue;
    throw UserError(
        {.place = "--full-scale",
         .problem = fmt::format("is {:g}, must be above --min-counts, {:g}", most[i], least[i])});
  }
  return converters;
}

/// The known poses of --poses; empty without.
std::vector<KnownPose> PosesOf(const CsvReader& csv, const PoseColumns& columns,
                               const PoseRecordingFormat& format,
                               const std::vector<std::string>& channels) {
  if (format.poses.empty()) return {};
  if (!columns.angles.empty()) {
    csv.Fail(columns.angles.front().column + 1,
             "is a known angle: leave it out of the recording, or --poses");
  }
  return LoadPoseTable(format.poses, channels);
}

/// The angles of a pose table at each sample, NaN between poses.
/// Errors: UserError with the file of the table for a pose behind the end of the recording.
Signal AnglesOf(const std::vector<KnownPose>& poses, const std::vector<double>& time_s,
                std::size_t channels, const std::string& file) {
  if (poses.back().start_s > time_s.back()) {
    throw UserError({.place = file,
                     .problem = fmt::format("a pose begins at {} s, the recording ends at {:.6g} s",
                                            poses.back().start_s, time_s.back())});
  }
  Signal angle_deg(std::ssize(time_s), channels);
  auto pose = poses.begin();
  for (std::size_t k = 0; k < time_s.size(); ++k) {
    while (pose != poses.end() && pose->end_s <= time_s[k]) ++pose;
    const bool known = pose != poses.end() && pose->start_s <= time_s[k];
    for (std::size_t c = 0; c < channels; ++c) {
      angle_deg(k, c) = known ? pose->angle_deg[c] : kMissing;
    }
  }
  return angle_deg;
}

/// Samples of the stretches that the user named as still.
std::vector<controller::StillStretch> SamplesOf(const std::vector<TimeStretch>& stretches,
                                                const std::vector<double>& time_s) {
  constexpr Eigen::Index kFewestSamples = 10;
  std::vector<controller::StillStretch> samples;
  for (const TimeStretch& stretch : stretches) {
    const auto begin = std::ranges::lower_bound(time_s, stretch.start_s);
    const auto end = std::ranges::lower_bound(time_s, stretch.end_s);
    const controller::StillStretch found = {.begin = begin - time_s.begin(),
                                            .end = end - time_s.begin()};
    const auto complain = [&](const std::string& problem) {
      throw UserError({.place = fmt::format("--still {}:{}", stretch.start_s, stretch.end_s),
                       .problem = problem});
    };
    // A stretch may end at the end of the last row, which lasts as long as the others.
    const double last_s = time_s.back() * (1.0 + 1.0 / static_cast<double>(time_s.size() - 1));
    if (stretch.end_s > last_s + 1e-6) {
      complain(fmt::format("the recording ends at {:.6g} s", time_s.back()));
    }
    if (found.end - found.begin < kFewestSamples) {
      complain(fmt::format("holds {} samples, must have {} or more", found.end - found.begin,
                           kFewestSamples));
    }
    for (const controller::StillStretch& other : samples) {
      if (found.begin < other.end && other.begin < found.end) complain("overlaps another");
    }
    samples.push_back(found);
  }
  return samples;
}

}  // namespace

void KeepSettledPoses(Eigen::Index settle_samples, Eigen::Ref<Eigen::VectorXd> angle_deg) {
  double held = kMissing;
  Eigen::Index since = 0;
  for (Eigen::Index k = 0; k < angle_deg.size(); ++k) {
    const double angle = std::round(angle_deg[k] * 1e6) / 1e6 + 0.0;  // + 0.0: no negative zero
    if (!(angle == held)) since = k;
    held = angle;
    angle_deg[k] = k - since >= settle_samples ? angle : kMissing;
  }
}

PoseRecording LoadPoseRecording(const std::filesystem::path& file,
                                const PoseRecordingFormat& format) {
  FoundTable table =
      FindTable(file.string(), TableSource(file, format.array), ProblemHandling::kAllowMissing);
  CsvReader& csv = table.reader;
  const PoseColumns columns = FindPoseColumns(table, format);
  std::vector<std::size_t> used;
  for (const ChannelColumn& c : columns.counts) used.push_back(c.column);
  for (const ChannelColumn& c : columns.angles) used.push_back(c.column);
  ReadOnly(columns.time, used, csv);
  if (columns.hand) KeepHand(*columns.hand, csv);
  PoseRecording recording;
  recording.name = OneLine(file.string());  // as results show it
  recording.columns_unknown = columns.unknown;
  recording.converters = ConvertersIn(columns, format);
  for (const ChannelColumn& c : columns.counts) recording.channel_names.push_back(c.channel);
  const std::vector<KnownPose> poses = PosesOf(csv, columns, format, recording.channel_names);
  const Rows rows = ReadRows(csv, columns, format.rate_hz, recording);
  const std::size_t rows_per_sample = columns.time.empty() ? 1 : RowsPerSample(rows.distances);
  const std::size_t samples_expected = (rows.count_in_file - 1) / rows_per_sample + 1;
  recording.rows_left_out = std::max(samples_expected, rows.count) - rows.count;
  recording.rows_beyond_scale = rows.beyond_scale.rows;
  recording.rows_left_out -= std::min(recording.rows_left_out, recording.rows_beyond_scale);
  recording.settle_ms = format.settle_ms;
  recording.rate_hz = format.rate_hz;
  FindStretches(rows, !columns.time.empty(), recording);
  using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  recording.counts =
      Eigen::Map<const RowMatrix>(rows.counts.data(), rows.count, columns.counts.size());
  recording.resolution_counts = ResolutionOf(recording.counts);
  recording.still = SamplesOf(format.still, rows.time_s);
  recording.angle_deg = poses.empty()
                            ? Signal(Eigen::Map<const RowMatrix>(rows.angle_deg.data(), rows.count,
                                                                 columns.angles.size()))
                            : AnglesOf(poses, rows.time_s, columns.counts.size(), format.poses);
  const Eigen::Index settle = std::lround(format.settle_ms * 1e-3 * recording.rate_hz);
  for (Eigen::Index c = 0; c < recording.angle_deg.cols(); ++c) {
    KeepSettledPoses(settle, recording.angle_deg.col(c));
  }
  return recording;
}

}  // namespace gauntlet::sim
