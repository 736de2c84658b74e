#include "sim/recordings/column_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <utility>

#include "sim/base/channels.h"
#include "sim/base/nearest_name.h"
#include "sim/recordings/time_columns.h"

namespace gauntlet::sim {
namespace {

constexpr std::array<std::pair<std::string_view, RecordedUnit>, 4> kUnits = {
    {{"deg", RecordedUnit::kDegrees},
     {"rad", RecordedUnit::kRadians},
     {"counts", RecordedUnit::kCounts},
     {"share", RecordedUnit::kShare}}};
constexpr std::array<std::pair<std::string_view, double>, 3> kTimeUnits = {
    {{"s", 1.0}, {"ms", 1e-3}, {"us", 1e-6}}};

template <class Value, std::size_t kSize>
const Value* FindIn(const std::array<std::pair<std::string_view, Value>, kSize>& list,
                    std::string_view name) {
  const auto found = std::ranges::find(list, name, &std::pair<std::string_view, Value>::first);
  return found == list.end() ? nullptr : &found->second;
}

std::optional<int> FindChannel(std::string_view name) {
  const auto channels = KnownChannels();
  const auto found = std::ranges::find(channels, name, &Channel::name);
  if (found == channels.end()) return std::nullopt;
  return found - channels.begin();
}

/// True and part of the map if the name means something.
bool AddByName(std::string_view name, std::size_t column, ColumnMap& map) {
  if (const auto channel = FindChannel(name)) {
    map.channels.push_back({.column = column, .channel = *channel});
    return true;
  }
  if (const auto scale_s = TimeScaleS(name); scale_s && !map.time_column) {
    map.time_column = column;
    map.time_scale_s = *scale_s;
    return true;
  }
  if (IsSampleNumber(name)) return true;
  const std::size_t cut = std::min(name.rfind('_'), name.size());
  const RecordedUnit* unit = FindIn(kUnits, name.substr(std::min(cut + 1, name.size())));
  const auto channel = FindChannel(name.substr(0, cut));
  if (unit == nullptr || !channel) return false;
  map.channels.push_back({.column = column, .channel = *channel, .unit = *unit});
  return true;
}

/// The first channel that appears twice.
std::optional<ColumnMapping> Repeated(const ColumnMap& map) {
  std::vector<bool> seen(KnownChannels().size(), false);
  for (const ColumnMapping& mapping : map.channels) {
    if (seen[mapping.channel]) return mapping;
    seen[mapping.channel] = true;
  }
  return std::nullopt;
}

std::string ChannelText(const ColumnMapping& mapping) {
  return std::string(KnownChannels()[mapping.channel].name);
}

/// The text table of a map file.
class MapFile {
 public:
  explicit MapFile(const std::filesystem::path& path)
      : csv_(path.string(), FileSource(path), ProblemHandling::kStrict) {
    const std::vector<std::string>& header = csv_.header();
    for (std::size_t i = 0; i < header.size(); ++i) {
      if (std::ranges::find(kKeys, header[i]) == kKeys.end()) {
        csv_.Fail(i + 1, fmt::format("unknown key {}{}", Quoted(header[i]),
                                     Suggestion(header[i], {kKeys.begin(), kKeys.end()})));
      }
    }
    if (Find("column") == header.size()) csv_.Fail(1, "there is no key column");
    if (Find("channel") == header.size()) csv_.Fail(1, "there is no key channel");
  }

  bool NextRow() { return csv_.NextRow(cells_); }

  std::string Text(std::string_view key, std::string_view fallback) const {
    const std::size_t place = Find(key);
    if (place == csv_.header().size() || cells_[place].empty()) return std::string(fallback);
    return cells_[place];
  }
  double Number(std::string_view key, double fallback) {
    const std::string text = Text(key, "");
    return text.empty() ? fallback : csv_.Number(text, Find(key) + 1);
  }
  [[noreturn]] void FailAt(std::string_view key, const std::string& problem) const {
    csv_.Fail(Find(key) + 1, problem);
  }

 private:
  static constexpr std::array<std::string_view, 6> kKeys = {"column", "channel", "unit",
                                                            "scale",  "sign",    "offset"};

  std::size_t Find(std::string_view key) const {
    return std::ranges::find(csv_.header(), key) - csv_.header().begin();
  }

  CsvReader csv_;
  std::vector<std::string> cells_;
};

std::size_t ColumnOf(const MapFile& map, const CsvReader& recording) {
  const std::string name = map.Text("column", "");
  const auto& header = recording.header();
  const auto found = std::ranges::find(header, name);
  if (!name.empty() && found != header.end()) {
    return found - header.begin();
  }
  std::size_t number = 0;
  const auto result = std::from_chars(name.data(), name.data() + name.size(), number);
  if (result.ec == std::errc() && result.ptr == name.data() + name.size() && number >= 1 &&
      number <= recording.column_count()) {
    return number - 1;
  }
  map.FailAt("column", fmt::format("{} has no column {}, must be one of its names or 1 to {}",
                                   recording.name(), Quoted(name), recording.column_count()));
}

}  // namespace

ColumnMap MapByHeader(const CsvReader& recording, ProblemHandling handling,
                      std::vector<std::string>& left_out) {
  if (recording.header().empty()) {
    recording.Fail(1, "the first line must name the columns, or a column map must be given");
  }
  ColumnMap map;
  for (std::size_t column = 0; column < recording.column_count(); ++column) {
    const std::string& name = recording.header()[column];
    if (AddByName(name, column, map)) continue;
    if (handling == ProblemHandling::kRepair) {
      left_out.push_back(name);
      continue;
    }
    recording.Fail(column + 1, fmt::format("unknown column {}{}", Quoted(name),
                                           Suggestion(name, KnownChannelNames())));
  }
  if (const auto twice = Repeated(map)) {
    recording.Fail(twice->column + 1, fmt::format("{} appears twice", ChannelText(*twice)));
  }
  if (map.channels.empty()) recording.Fail(1, "there is no column of a channel");
  return map;
}

ColumnMap ReadColumnMap(const std::filesystem::path& path, const CsvReader& recording) {
  MapFile file(path);
  ColumnMap map;
  while (file.NextRow()) {
    const std::size_t column = ColumnOf(file, recording);
    const std::string channel = file.Text("channel", "");
    if (channel == "time") {
      const std::string unit = file.Text("unit", "s");
      const double* scale = FindIn(kTimeUnits, unit);
      if (scale == nullptr) file.FailAt("unit", Quoted(unit) + " must be one of: s, ms, us");
      map.time_column = column;
      map.time_scale_s = *scale;
      continue;
    }
    const auto index = FindChannel(channel);
    if (!index) {
      file.FailAt("channel", fmt::format("unknown channel {}{}", Quoted(channel),
                                         Suggestion(channel, KnownChannelNames())));
    }
    const std::string unit = file.Text("unit", "deg");
    const RecordedUnit* known = FindIn(kUnits, unit);
    if (known == nullptr) {
      file.FailAt("unit", Quoted(unit) + " must be one of: deg, rad, counts, share");
    }
    const double sign = file.Number("sign", 1.0);
    if (std::abs(sign) != 1.0) file.FailAt("sign", "must be 1 or -1");
    map.channels.push_back({.column = column,
                            .channel = *index,
                            .unit = *known,
                            .scale = sign * file.Number("scale", 1.0),
                            .offset = file.Number("offset", 0.0)});
    if (Repeated(map)) file.FailAt("channel", channel + " appears twice");
  }
  if (map.channels.empty()) file.FailAt("channel", "the map names no channel");
  return map;
}

}  // namespace gauntlet::sim
