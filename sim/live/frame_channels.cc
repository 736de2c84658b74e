#include "sim/live/frame_channels.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim/base/channels.h"
#include "sim/base/error.h"
#include "sim/base/shell_word.h"
#include "sim/base/text.h"
#include "sim/recordings/column_map.h"
#include "sim/recordings/column_scale.h"

namespace gauntlet::sim {
namespace {

/// The columns that hold values: not the number of the frame, nor a time.
std::vector<std::size_t> ValueColumns(const DeviceColumns& columns) {
  std::vector<std::size_t> values;
  for (std::size_t column = 0; column < columns.count; ++column) {
    const bool is_time =
        std::ranges::find(columns.time, column, &TimeMapping::column) != columns.time.end();
    if (!is_time && columns.number != column) values.push_back(column);
  }
  return values;
}

/// By names of channels, as of a recording without a map; no channels if a column has another name.
/// A column without a name beside others, as behind a separator at the end of a line, is left out.
ColumnMap MapByNames(const DeviceColumns& columns, std::vector<std::size_t> values,
                     const std::string& unit) {
  if (columns.names.size() != columns.count) return {};
  std::erase_if(values, [&](std::size_t column) { return columns.names[column].empty(); });
  if (values.empty()) return {};
  std::vector<std::string> names;
  for (const std::size_t column : values) names.push_back(columns.names[column]);
  const std::string text = fmt::format("{}\n{}\n", fmt::join(names, ","),
                                       fmt::join(std::vector<int>(names.size()), ","));
  ColumnMap map;
  try {
    std::vector<std::string> left_out;
    map = MapByHeader(CsvReader("frames", TextSource(text), ProblemHandling::kStrict),
                      ProblemHandling::kStrict, left_out, unit.empty() ? "deg" : unit);
  } catch (const UserError&) {
    return {};  // other names, which say nothing
  }
  for (ColumnMapping& mapping : map.channels) mapping.column = values[mapping.column];
  return map;
}

/// True if a column gives counts of the glove's own converter, of which nothing else is known.
bool AreGloveCounts(const ColumnMapping& mapping, const controller::ConverterRange& range) {
  const bool fits = mapping.bits == 0 || std::ldexp(1.0, mapping.bits) - 1.0 == range.span_counts();
  return mapping.unit == RecordedUnit::kCounts && !mapping.points && fits && mapping.scale == 1.0 &&
         mapping.offset == 0.0 && mapping.weight == 1.0;
}

}  // namespace

FrameChannels::FrameChannels(FrameChannelsConfig config)
    : config_(std::move(config)), counts_(config_.glove.channel_names.size()) {}

void FrameChannels::Fail(const std::string& problem) const {
  throw UserError({.place = config_.source, .problem = problem});
}

std::span<const double> FrameChannels::Counts(const DeviceColumns& columns, double time_s,
                                              std::span<const double> values) {
  if (columns.version != version_) Configure(columns);
  for (std::size_t c = 0; c < channels_.size(); ++c) {
    counts_[c] = channels_.Next(c, time_s, values);
  }
  return counts_;
}

void FrameChannels::ConfigureInOrder(const DeviceColumns& columns) {
  const std::vector<std::string>& names = config_.glove.channel_names;
  const std::vector<std::size_t> values = ValueColumns(columns);
  std::vector<std::string> known;
  for (const std::size_t column : values) {
    if (column < columns.names.size() && !columns.names[column].empty()) {
      known.push_back(columns.names[column]);
    }
  }
  const std::string of_names =
      known.empty() ? "" : fmt::format(" ({})", Shown(fmt::format("{}", fmt::join(known, ", "))));
  if (values.size() != names.size()) {
    Fail(fmt::format(
        "a frame has {} value{}{}, the glove has {} channel{}; --map FILE.csv names the "
        "channel of each column, and --set {} the channels of the glove",
        values.size(), values.size() == 1 ? "" : "s", of_names, names.size(),
        names.size() == 1 ? "" : "s", ShellWord("glove.channels=[..]")));
  }
  std::vector<ChannelValues::Parts> channels;
  for (const std::size_t column : values) channels.push_back({{.column = column}});
  channels_ = ChannelValues(std::move(channels));
  remark_ = fmt::format(
      "{} values a frame{} are the counts of {} to {} in this order; --map says "
      "otherwise",
      values.size(), of_names, names.front(), names.back());
}

void FrameChannels::Configure(const DeviceColumns& columns) {
  version_ = columns.version;
  const ColumnMap map = config_.map.empty()
                            ? MapByNames(columns, ValueColumns(columns), config_.unit)
                            : ReadColumnMap(config_.map, RecordingColumns{.name = config_.source,
                                                                          .header = columns.names,
                                                                          .count = columns.count});
  if (config_.map.empty() && map.channels.empty()) return ConfigureInOrder(columns);
  const controller::GloveCalibration& glove = config_.glove;
  const std::vector<controller::ConverterRange> converters = controller::ConvertersOf(glove);
  std::vector<ChannelValues::Parts> channels(glove.channel_names.size());
  std::vector<std::string> missing;
  for (std::size_t c = 0; c < channels.size(); ++c) {
    const int known = ChannelIndex(glove.channel_names[c]);
    const double counts_per_rad = (glove.high_counts[c] - glove.low_counts[c]) /
                                  (glove.high_angle_rad[c] - glove.low_angle_rad[c]);
    const auto is_of_channel = [known](const ColumnMapping& mapping) {
      return mapping.channel == known;
    };
    const bool is_only = std::ranges::count_if(map.channels, is_of_channel) == 1;
    for (const ColumnMapping& mapping : map.channels) {
      if (!is_of_channel(mapping)) continue;
      ChannelValues::Part& part =
          channels[c].emplace_back(PartOf(mapping, {.min_counts = converters[c].min_counts,
                                                    .low_counts = glove.low_counts[c],
                                                    .high_counts = glove.high_counts[c]}));
      part.factor *= counts_per_rad;
      part.offset *= counts_per_rad;
      if (is_only && AreGloveCounts(mapping, converters[c])) {
        part = {.column = mapping.column, .wraps_at = mapping.wraps_at};
      } else if (channels[c].size() == 1) {
        part.offset += glove.low_counts[c] - glove.low_angle_rad[c] * counts_per_rad;
      }
    }
    if (channels[c].empty()) missing.push_back(glove.channel_names[c]);
  }
  if (!missing.empty()) {
    std::vector<std::string> given;
    for (const std::string& name : glove.channel_names) {
      if (std::ranges::find(missing, name) == missing.end()) given.push_back(name);
    }
    Fail(fmt::format(
        "no column gives {}; {}", Shown(fmt::format("{}", fmt::join(missing, ", "))),
        given.empty() ? "--map FILE.csv names the channel of each column"
                      : "a glove without them: --set " +
                            ShellWord(fmt::format("glove.channels=[{}]", fmt::join(given, ",")))));
  }
  const std::string assumed = AssumptionsOf(map);
  if (!assumed.empty() && config_.drives_motors) {
    Fail(fmt::format("the map {} drives motors only once it is confirmed: {}", config_.map,
                     assumed));
  }
  channels_ = ChannelValues(std::move(channels));
  std::vector<std::string> remarks = EnvelopesOf(map);
  if (!assumed.empty()) remarks.push_back(assumed);
  remark_ = fmt::format("{}", fmt::join(remarks, "; "));
}

}  // namespace gauntlet::sim
