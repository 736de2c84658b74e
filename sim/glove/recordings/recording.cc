#include "sim/glove/recordings/recording.h"

#include <fmt/format.h>

#include <optional>

#include "sim/base/error.h"
#include "sim/glove/channels.h"
#include "sim/glove/recordings/csv_reader.h"

namespace gauntlet::sim {
namespace {

struct Columns {
  std::optional<std::size_t> time;
  std::vector<std::pair<std::size_t, int>> channels;  // column, channel
};

Columns FindColumns(const CsvReader& reader) {
  if (reader.header().empty()) {
    reader.Fail(1, "the first line must name the columns: time_s and channels");
  }
  Columns columns;
  std::vector<bool> seen(GloveChannels().size(), false);
  for (std::size_t column = 0; column < reader.column_count(); ++column) {
    const std::string& name = reader.header()[column];
    if (name == "time_s") {
      if (columns.time) reader.Fail(column + 1, "column time_s stands twice");
      columns.time = column;
      continue;
    }
    int channel = 0;
    try {
      channel = ChannelIndex(name);
    } catch (const UserError& error) {
      reader.Fail(column + 1, error.what());
    }
    if (seen[channel]) reader.Fail(column + 1, fmt::format("column {} stands twice", name));
    seen[channel] = true;
    columns.channels.emplace_back(column, channel);
  }
  if (!columns.time) reader.Fail(1, "there is no column time_s");
  if (columns.channels.empty()) reader.Fail(1, "there is no column of a channel");
  return columns;
}

}  // namespace

Recording LoadRecording(const std::filesystem::path& file) {
  CsvReader reader(file.string(), FileSource(file), ProblemHandling::kStrict);
  const Columns columns = FindColumns(reader);
  Recording recording{.name = file.string(), .time_s = {}, .angle_rad = {}, .has_channel = {}};
  recording.has_channel.assign(GloveChannels().size(), false);
  for (const auto& [column, channel] : columns.channels) recording.has_channel[channel] = true;

  std::vector<double> row(reader.column_count());
  std::vector<double> angles;  // row by row
  while (reader.NextRow(row)) {
    const double time_s = row[*columns.time];
    if (!recording.time_s.empty() && time_s <= recording.time_s.back()) {
      reader.Fail(*columns.time + 1, fmt::format("time_s is {}, must be above {} of the row before",
                                                 time_s, recording.time_s.back()));
    }
    recording.time_s.push_back(time_s);
    for (const auto& [column, channel] : columns.channels) {
      angles.push_back(row[column] * kRadPerDeg);
    }
  }
  if (recording.time_s.size() < 2) reader.Fail(1, "the file holds fewer than two rows of data");

  const std::size_t width = columns.channels.size();
  recording.angle_rad.setZero(static_cast<Eigen::Index>(recording.time_s.size()),
                              static_cast<Eigen::Index>(GloveChannels().size()));
  for (std::size_t j = 0; j < width; ++j) {
    auto target = recording.angle_rad.col(columns.channels[j].second);
    for (std::size_t i = 0; i < recording.time_s.size(); ++i) {
      target[static_cast<Eigen::Index>(i)] = angles[i * width + j];
    }
  }
  return recording;
}

}  // namespace gauntlet::sim
