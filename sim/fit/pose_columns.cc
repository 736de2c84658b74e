#include "sim/fit/pose_columns.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <utility>

#include "sim/base/channels.h"
#include "sim/base/nearest_name.h"
#include "sim/base/signal.h"
#include "sim/recordings/column_map.h"
#include "sim/recordings/column_scale.h"
#include "sim/recordings/time_guess.h"
#include "sim/tables/time_columns.h"

namespace gauntlet::sim {
namespace {

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
    // `target_angle_rad.NAME` and similar columns are other signals of a trace.
    if (pattern.after.empty() && channel.find('.') != std::string::npos) continue;
    (pattern.is_angle ? columns.angles : columns.counts)
        .push_back({.column = column, .channel = channel, .scale = pattern.scale});
    return true;
  }
  return false;
}

bool IsTime(const std::string& name, std::size_t column, const PoseColumns& columns) {
  return TimeScaleS(name) || IsSampleNumber(name) ||
         std::ranges::find(columns.time, column, &TimeMapping::column) != columns.time.end();
}

void RejectRepeats(const CsvReader& csv, const std::vector<ChannelColumn>& columns) {
  for (std::size_t i = 0; i < columns.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (columns[i].channel != columns[j].channel) continue;
      csv.Fail(columns[i].column + 1,
               fmt::format("{} appears twice", csv.Quoted(columns[i].channel)));
    }
  }
}

/// Sorts the angles in the order of the counts.
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
                           csv.Quoted(counts.channel), counts.channel));
    }
    ordered.push_back(*found);
  }
  for (const ChannelColumn& angle : columns.angles) {
    if (std::ranges::find(channels, angle.channel) != channels.end()) continue;
    csv.Fail(angle.column + 1,
             fmt::format("{} has a known angle but no counts{}", csv.Quoted(angle.channel),
                         Suggestion(angle.channel, channels)));
  }
  columns.angles = std::move(ordered);
}

/// `index_mcp`, the name of a channel alone, in the unit that a person gave.
bool AddInUnit(const std::string& name, std::size_t column, const std::string& unit,
               PoseColumns& columns) {
  const auto channels = KnownChannels();
  if (unit.empty() || std::ranges::find(channels, name, &Channel::name) == channels.end()) {
    return false;
  }
  if (unit == "deg" || unit == "rad") {
    columns.angles.push_back({column, name, unit == "deg" ? 1.0 : kDegPerRad});
  } else {
    columns.counts.push_back({column, name});
  }
  return true;
}

PoseColumns ColumnsByName(const FoundTable& table, const PoseRecordingFormat& format) {
  const CsvReader& csv = table.reader;
  const std::vector<std::string>& names = table.layout.names;
  PoseColumns columns;
  columns.time = TimeByName(csv.name(), table.layout, format.time_unit);
  std::size_t first_unknown = 0;
  for (std::size_t column = 0; column < csv.column_count(); ++column) {
    const std::string& name = names[column];
    if (IsTime(name, column, columns) || AddChannel(name, column, columns) ||
        AddInUnit(name, column, format.unit, columns)) {
      continue;
    }
    if (name.find('.') != std::string::npos) continue;  // another signal of a trace
    if (columns.unknown.empty()) first_unknown = column;
    columns.unknown.push_back(name);
  }
  if (columns.counts.empty() && !columns.unknown.empty()) {
    csv.Fail(
        first_unknown + 1,
        fmt::format("unknown column {}, must be a time (as t_s or time_ms), k, or a channel's "
                    "name with _counts, _deg or _rad behind it; or --unit or --map says what it is",
                    csv.Quoted(names[first_unknown])));
  }
  return columns;
}

/// Uses only the time columns, sensor columns and bits of the map: scale and offset are the
/// unknowns of the calibration. Known angles have the names of the channels.
PoseColumns ColumnsByMap(const FoundTable& table, const std::string& file) {
  const CsvReader& csv = table.reader;
  const std::vector<std::string>& names = table.layout.names;
  const ColumnMap map = ReadColumnMap(file, {.name = csv.name(),
                                             .header = names,
                                             .count = table.layout.columns,
                                             .may_choose_rows = true});
  PoseColumns columns;
  columns.hand = map.hand;
  columns.time = map.time;
  std::vector<bool> used(csv.column_count(), false);
  for (const TimeMapping& time : map.time) used[time.column] = true;
  for (const ColumnMapping& mapping : map.channels) {
    const std::string channel(KnownChannels()[mapping.channel].name);
    used[mapping.column] = true;
    if (std::ranges::find(columns.counts, channel, &ChannelColumn::channel) !=
        columns.counts.end()) {
      csv.Fail(mapping.column + 1,
               fmt::format("is a second column of {} in the map, a calibration is of one sensor "
                           "per channel",
                           channel));
    }
    columns.counts.push_back({.column = mapping.column, .channel = channel, .bits = mapping.bits});
  }
  for (std::size_t column = 0; column < names.size(); ++column) {
    if (used[column]) continue;
    PoseColumns one;
    const bool is_angle = AddChannel(names[column], column, one) && !one.angles.empty() &&
                          std::ranges::find(columns.counts, one.angles.front().channel,
                                            &ChannelColumn::channel) != columns.counts.end();
    if (is_angle) columns.angles.push_back(one.angles.front());
  }
  return columns;
}

}  // namespace

PoseColumns FindPoseColumns(const FoundTable& table, const PoseRecordingFormat& format) {
  const std::string& map = format.map;
  const CsvReader& csv = table.reader;
  const bool has_names = std::ranges::any_of(table.layout.names,
                                             [](const std::string& name) { return !name.empty(); });
  if (map.empty() && !has_names) csv.Fail(1, "the first line must name the columns, or --map");
  PoseColumns columns = map.empty() ? ColumnsByName(table, format) : ColumnsByMap(table, map);
  if (columns.counts.empty()) csv.Fail(1, "there is no column of counts (as index_mcp_counts)");
  RejectRepeats(csv, columns.counts);
  RejectRepeats(csv, columns.angles);
  PairUp(csv, columns);
  return columns;
}

}  // namespace gauntlet::sim
