#include "sim/fit/pose_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "sim/base/nearest_name.h"
#include "sim/base/signal.h"
#include "sim/tables/csv_reader.h"

namespace gauntlet::sim {
namespace {

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

}  // namespace

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

}  // namespace gauntlet::sim
