#include "sim/calibrate/pose_recording.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <optional>
#include <string_view>

#include "sim/base/error.h"
#include "sim/base/nearest_name.h"
#include "sim/base/text.h"
#include "sim/recordings/csv_reader.h"
#include "sim/recordings/time_columns.h"

namespace gauntlet::sim {
namespace {

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kFewestRows = 10;

/// A column of a channel's counts or angle; `scale` brings the angle to degrees.
struct ChannelColumn {
  std::size_t column = 0;
  std::string channel;
  double scale = 1.0;
};

/// Which column of the file is what.
struct PoseColumns {
  std::optional<std::size_t> time;
  double time_scale_s = 1.0;
  std::vector<ChannelColumn> counts;
  std::vector<ChannelColumn> angles;  // in the order of `counts` once sorted
  std::size_t left_out = 0;
};

struct NamePattern {
  std::string_view before;
  std::string_view after;
  bool is_angle;
  double scale;
};
constexpr NamePattern kPatterns[] = {{"", "_counts", false, 1.0},
                                     {"counts.", "", false, 1.0},
                                     {"", "_deg", true, 1.0},
                                     {"true_angle_rad.", "", true, kDegPerRad},
                                     {"", "_rad", true, kDegPerRad}};

bool AddChannel(const std::string& name, std::size_t column, PoseColumns& columns) {
  for (const NamePattern& pattern : kPatterns) {
    if (!name.starts_with(pattern.before) || !name.ends_with(pattern.after) ||
        name.size() <= pattern.before.size() + pattern.after.size()) {
      continue;
    }
    const std::string channel = name.substr(
        pattern.before.size(), name.size() - pattern.before.size() - pattern.after.size());
    // `target_angle_rad.NAME` and its like are other signals of a trace.
    if (pattern.after.empty() && channel.find('.') != std::string::npos) continue;
    (pattern.is_angle ? columns.angles : columns.counts)
        .push_back({column, channel, pattern.scale});
    return true;
  }
  return false;
}

bool AddTime(const std::string& name, std::size_t column, PoseColumns& columns) {
  const auto scale_s = TimeScaleS(name);
  if (!scale_s) return IsSampleNumber(name);
  columns.time = column;
  columns.time_scale_s = *scale_s;
  return true;
}

void RejectRepeats(const CsvReader& csv, const std::vector<ChannelColumn>& columns) {
  for (std::size_t i = 0; i < columns.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (columns[i].channel != columns[j].channel) continue;
      csv.Fail(columns[i].column + 1, fmt::format("{} appears twice", Quoted(columns[i].channel)));
    }
  }
}

/// Puts the angles in the order of the counts.
void PairUp(const CsvReader& csv, PoseColumns& columns) {
  if (columns.angles.empty()) return;
  std::vector<std::string> channels;
  std::vector<ChannelColumn> ordered;
  for (const ChannelColumn& counts : columns.counts) {
    channels.push_back(counts.channel);
    const auto found = std::ranges::find(columns.angles, counts.channel, &ChannelColumn::channel);
    if (found == columns.angles.end()) {
      csv.Fail(counts.column + 1,
               fmt::format("{} has counts but no known angle, add a column {}_deg",
                           Quoted(counts.channel), counts.channel));
    }
    ordered.push_back(*found);
  }
  for (const ChannelColumn& angle : columns.angles) {
    if (std::ranges::find(channels, angle.channel) != channels.end()) continue;
    csv.Fail(angle.column + 1,
             fmt::format("{} has a known angle but no counts{}", Quoted(angle.channel),
                         Suggestion(angle.channel, channels)));
  }
  columns.angles = std::move(ordered);
}

PoseColumns FindColumns(const CsvReader& csv) {
  if (csv.header().empty()) csv.Fail(1, "the first line must name the columns");
  PoseColumns columns;
  for (std::size_t column = 0; column < csv.column_count(); ++column) {
    const std::string& name = csv.header()[column];
    if (AddTime(name, column, columns) || AddChannel(name, column, columns)) continue;
    if (name.find('.') == std::string::npos) {
      csv.Fail(column + 1,
               fmt::format("unknown column {}, must be a time (as t_s or time_ms), k, or a "
                           "channel's name with _counts, _deg or _rad behind it",
                           Quoted(name)));
    }
    ++columns.left_out;
  }
  if (columns.counts.empty()) csv.Fail(1, "there is no column of counts (as index_mcp_counts)");
  RejectRepeats(csv, columns.counts);
  RejectRepeats(csv, columns.angles);
  PairUp(csv, columns);
  return columns;
}

/// Values that no converter of this scale gives: glitches of its line, or it has another scale.
struct BeyondScale {
  std::size_t rows = 0;
  // The first of them.
  std::size_t row = 0;
  std::size_t column = 0;
  double counts = 0.0;
};

/// The rows of the file, and the times of the first and the last.
struct Rows {
  std::vector<double> counts;
  std::vector<double> angle_deg;
  double first_s = kMissing;
  double last_s = kMissing;
  std::size_t count = 0;
  std::vector<std::size_t> distances;  // from each row with counts to the next, in rows of the file
  BeyondScale beyond_scale;
};

/// Every how many rows of the file there are counts: a trace of a slow glove has rows in between.
std::size_t RowsPerSample(std::vector<std::size_t> distances) {
  if (distances.empty()) return 1;
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::ranges::nth_element(distances, middle);
  return *middle;
}

void TakeTime(const CsvReader& csv, const PoseColumns& columns, const std::vector<double>& values,
              Rows& rows) {
  if (!columns.time) return;
  const double time_s = values[*columns.time] * columns.time_scale_s;
  if (std::isnan(time_s)) csv.Fail(*columns.time + 1, "the time is missing");
  if (time_s <= rows.last_s) {
    csv.Fail(*columns.time + 1,
             fmt::format("the time is {} s, must be above the {} s of the row before", time_s,
                         rows.last_s));
  }
  if (std::isnan(rows.first_s)) rows.first_s = time_s;
  rows.last_s = time_s;
}

bool IsBeyondScale(const CsvReader& csv, const PoseColumns& columns,
                   const std::vector<double>& values, double full_scale_counts, Rows& rows) {
  for (const ChannelColumn& c : columns.counts) {
    const double counts = values[c.column];
    if (counts >= 0.0 && counts <= full_scale_counts) continue;
    if (rows.beyond_scale.rows++ == 0) {
      rows.beyond_scale = {.rows = 1, .row = csv.row(), .column = c.column, .counts = counts};
    }
    return true;
  }
  return false;
}

/// A few such values are glitches.
void RejectAnotherScale(const CsvReader& csv, const Rows& rows, double full_scale_counts) {
  constexpr double kMostShare = 0.05;
  const BeyondScale& beyond = rows.beyond_scale;
  if (static_cast<double>(beyond.rows) <=
      kMostShare * static_cast<double>(beyond.rows + rows.count)) {
    return;
  }
  csv.FailInRow(
      beyond.row, beyond.column + 1,
      fmt::format("is {} counts, must be from 0 to the converter's full scale of {} "
                  "(--full-scale); {} of {} rows have such values",
                  beyond.counts, full_scale_counts, beyond.rows, beyond.rows + rows.count));
}

}  // namespace

void KeepSettledPoses(Eigen::Index settle_samples, Eigen::Ref<Eigen::VectorXd> angle_deg) {
  double held = kMissing;
  Eigen::Index since = 0;
  for (Eigen::Index k = 0; k < angle_deg.size(); ++k) {
    const double angle = std::round(angle_deg[k] * 1e6) / 1e6 + 0.0;  // no minus zero
    if (!(angle == held)) since = k;
    held = angle;
    angle_deg[k] = k - since >= settle_samples ? angle : kMissing;
  }
}

PoseRecording LoadPoseRecording(const std::filesystem::path& file,
                                const PoseRecordingFormat& format) {
  CsvReader csv(file.string(), FileSource(file), ProblemHandling::kAllowMissing);
  const PoseColumns columns = FindColumns(csv);
  std::vector<bool> used(csv.column_count(), false);
  if (columns.time) used[*columns.time] = true;
  for (const ChannelColumn& c : columns.counts) used[c.column] = true;
  for (const ChannelColumn& c : columns.angles) used[c.column] = true;
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (!used[i]) csv.Ignore(i);
  }

  PoseRecording recording;
  recording.name = OneLine(file.string());  // as results have it, too
  recording.columns_left_out = columns.left_out;
  recording.resolution_counts = 1.0;
  for (const ChannelColumn& c : columns.counts) recording.channel_names.push_back(c.channel);

  Rows rows;
  std::size_t row = 0;         // of the file
  std::size_t last_whole = 0;  // the newest row with all counts
  std::vector<double> values(csv.column_count());
  for (; csv.NextRow(values); ++row) {
    TakeTime(csv, columns, values, rows);
    const bool whole = std::ranges::none_of(
        columns.counts, [&](const ChannelColumn& c) { return std::isnan(values[c.column]); });
    if (!whole || IsBeyondScale(csv, columns, values, format.full_scale_counts, rows)) continue;
    if (rows.count++ > 0) rows.distances.push_back(row - last_whole);
    last_whole = row;
    for (const ChannelColumn& c : columns.counts) {
      const double counts = values[c.column];
      rows.counts.push_back(counts);
      if (counts != std::round(counts)) recording.resolution_counts = 0.0;
    }
    for (const ChannelColumn& c : columns.angles) {
      rows.angle_deg.push_back(values[c.column] * c.scale);
    }
  }
  RejectAnotherScale(csv, rows, format.full_scale_counts);
  if (rows.count < kFewestRows) {
    csv.Fail(1,
             fmt::format("the recording has {} rows without missing counts, must have at least {}",
                         rows.count, kFewestRows));
  }
  const std::size_t rows_per_sample = columns.time ? RowsPerSample(rows.distances) : 1;
  const std::size_t samples_expected = (row - 1) / rows_per_sample + 1;
  recording.rows_left_out = std::max(samples_expected, rows.count) - rows.count;
  recording.rows_beyond_scale = rows.beyond_scale.rows;
  recording.rows_left_out -= std::min(recording.rows_left_out, recording.rows_beyond_scale);
  recording.full_scale_counts = format.full_scale_counts;
  recording.settle_ms = format.settle_ms;
  recording.rate_hz = format.rate_hz;
  if (columns.time) {
    recording.rate_hz = (row - 1) / (rows.last_s - rows.first_s) / rows_per_sample;
  }
  using Table = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  recording.counts = Eigen::Map<const Table>(rows.counts.data(), rows.count, columns.counts.size());
  recording.angle_deg =
      Eigen::Map<const Table>(rows.angle_deg.data(), rows.count, columns.angles.size());
  const Eigen::Index settle = std::lround(format.settle_ms * 1e-3 * recording.rate_hz);
  for (Eigen::Index c = 0; c < recording.angle_deg.cols(); ++c) {
    KeepSettledPoses(settle, recording.angle_deg.col(c));
  }
  return recording;
}

}  // namespace gauntlet::sim
