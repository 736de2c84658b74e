#include "sim/recordings/column_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "controller/number.h"
#include "sim/base/channels.h"
#include "sim/base/csv_line.h"
#include "sim/base/nearest_name.h"
#include "sim/base/signal.h"
#include "sim/recordings/column_scale.h"
#include "sim/recordings/envelope.h"
#include "sim/recordings/profile.h"
#include "sim/recordings/time_guess.h"
#include "sim/tables/name_words.h"
#include "sim/tables/time_columns.h"

namespace gauntlet::sim {
namespace {

constexpr std::string_view kCounts = "counts";
constexpr std::array<std::pair<std::string_view, RecordedUnit>, 4> kUnits = {
    {{"deg", RecordedUnit::kDegrees},
     {"rad", RecordedUnit::kRadians},
     {kCounts, RecordedUnit::kCounts},
     {"share", RecordedUnit::kShare}}};
constexpr std::string_view kDateUnit = "date";
constexpr std::string_view kVolts = "volts";
constexpr std::array<std::string_view, 3> kRoles = {"command", "angle", "motor"};  // of a log

const RecordedUnit* FindUnit(std::string_view name) {
  const auto found =
      std::ranges::find(kUnits, name, &std::pair<std::string_view, RecordedUnit>::first);
  return found == kUnits.end() ? nullptr : &found->second;
}

std::optional<int> FindChannel(std::string_view name) {
  const auto channels = KnownChannels();
  const auto found = std::ranges::find(channels, name, &Channel::name);
  if (found == channels.end()) return std::nullopt;
  return found - channels.begin();
}

/// True and part of the map if the name means something.
bool AddByName(std::string_view name, std::size_t column, std::string_view unit_without,
               ColumnMap& map) {
  if (const auto channel = FindChannel(name)) {
    map.channels.push_back(
        {.column = column, .channel = *channel, .unit = *FindUnit(unit_without)});
    return true;
  }
  if (std::ranges::find(map.time, column, &TimeMapping::column) != map.time.end()) return true;
  if (IsSampleNumber(name)) return true;
  const std::size_t cut = std::min(name.rfind('_'), name.size());
  const RecordedUnit* unit = FindUnit(name.substr(std::min(cut + 1, name.size())));
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

/// The text table of a map.
class MapFile {
 public:
  /// `is_profile`: its names of columns are those of a device, see IsSameName(). A map of a person
  /// names columns exactly: `index_mcp` is not `index_mcp_rad`, which is in another unit.
  MapFile(const std::string& place, CsvReader::Source text, bool is_profile)
      : csv_(place, std::move(text), ProblemHandling::kStrict), is_profile_(is_profile) {
    const std::vector<std::string>& header = csv_.header();
    for (std::size_t i = 0; i < header.size(); ++i) {
      if (std::ranges::find(kKeys, header[i]) == kKeys.end()) {
        csv_.Fail(i + 1, fmt::format("unknown key {}{}", csv_.Quoted(header[i]),
                                     Suggestion(header[i], {kKeys.begin(), kKeys.end()})));
      }
    }
    if (Find("column") == header.size()) csv_.Fail(1, "there is no key column");
    if (Find("channel") == header.size()) csv_.Fail(1, "there is no key channel");
  }

  bool NextRow() { return csv_.NextRow(cells_); }
  bool is_profile() const { return is_profile_; }

  std::string Text(std::string_view key, std::string_view fallback) const {
    const std::size_t place = Find(key);
    if (place == csv_.header().size() || cells_[place].empty()) return std::string(fallback);
    return cells_[place];
  }
  bool Has(std::string_view key) const { return !Text(key, "").empty(); }
  double Number(std::string_view key, double fallback) {
    return Has(key) ? csv_.Number(Text(key, ""), Find(key) + 1) : fallback;
  }
  std::string Quoted(const std::string& cell) const { return csv_.Quoted(cell); }
  [[noreturn]] void FailAt(std::string_view key, const std::string& problem) const {
    csv_.Fail(std::min(Find(key), csv_.header().size() - 1) + 1, problem);
  }

 private:
  static constexpr std::array<std::string_view, 16> kKeys = {
      "column",  "channel",  "unit", "scale",  "sign",     "offset",  "raw_low", "raw_high",
      "deg_low", "deg_high", "bits", "weight", "wraps_at", "assumed", "joint",   "envelope_ms"};

  std::size_t Find(std::string_view key) const {
    return std::ranges::find(csv_.header(), key) - csv_.header().begin();
  }

  CsvReader csv_;
  bool is_profile_ = false;
  std::vector<std::string> cells_;
};

/// A file, or the map of a profile: by its name where there is no such file, or by its file.
MapFile OpenMap(const std::filesystem::path& map) {
  std::error_code unreadable;
  const bool is_name = !map.has_extension() && !std::filesystem::exists(map, unreadable);
  const std::filesystem::path profile =
      is_name ? FileOfProfile(map.filename().string()) : std::filesystem::path();
  if (!profile.empty()) return {profile.string(), TextSource(ReadProfile(profile).map), true};
  if (map.extension() == ".yaml") return {map.string(), TextSource(ReadProfile(map).map), true};
  return {map.string(), FileSource(map), false};
}

void AddTime(const MapFile& file, std::size_t column, std::vector<TimeMapping>& time) {
  const std::string unit = file.Text("unit", "s");
  if (unit == kDateUnit) {
    time.push_back({.column = column, .is_text = true});
    return;
  }
  const std::optional<double> scale_s = SecondsPerUnit(unit);
  if (!scale_s) {
    file.FailAt("unit",
                file.Quoted(unit) + " must be one of: s, ms, us, ns, ticks, min, h, day, date");
  }
  time.push_back({.column = column, .scale_s = *scale_s});
}

std::string UnitIn(const MapFile& file) {
  std::string unit = file.Text("unit", "deg");
  if (unit == kVolts || FindUnit(unit) != nullptr) return unit;
  file.FailAt("unit", file.Quoted(unit) + " must be one of: deg, rad, counts, share, volts");
}

/// Bits of the converter; 0 if the row has none.
int BitsIn(MapFile& file, std::string_view unit) {
  if (!file.Has("bits")) return 0;
  const double bits = file.Number("bits", 0.0);
  if (!(bits >= 1.0 && bits <= kMostMapBits && bits == std::floor(bits))) {
    file.FailAt("bits", fmt::format("must be a whole number from 1 to {}", kMostMapBits));
  }
  if (unit != kCounts) file.FailAt("bits", "is for counts only");
  return static_cast<int>(bits);
}

/// Two values of the column and the angles that they stand for, by default the ends of the joint's
/// range.
ColumnMapping TwoPoint(MapFile& file, std::size_t column, int channel) {
  const Channel& joint = KnownChannels()[channel];
  for (const std::string_view key : {"scale", "sign", "offset"}) {
    if (file.Has(key)) file.FailAt(key, "must be empty beside raw_low and raw_high");
  }
  const std::string unit = UnitIn(file);
  for (const std::string_view key : {"raw_low", "raw_high"}) {
    if (!file.Has(key)) file.FailAt(key, "must be given, as the other end is");
  }
  const double raw_low = file.Number("raw_low", 0.0);
  const double raw_high = file.Number("raw_high", 0.0);
  const double raw_range = raw_high - raw_low;
  if (raw_range == 0.0) file.FailAt("raw_high", "must not be raw_low");
  const double low_deg = file.Number("deg_low", joint.min_deg);
  const double scale = (file.Number("deg_high", joint.max_deg) - low_deg) / raw_range;
  return {.column = column,
          .channel = channel,
          .scale = scale,
          .offset = low_deg - raw_low * scale,
          .bits = BitsIn(file, unit),
          .in_counts = unit == kCounts,
          .points = RawPoints{.low = raw_low, .high = raw_high}};
}

ColumnMapping OnePoint(MapFile& file, std::size_t column, int channel) {
  for (const std::string_view key : {"deg_low", "deg_high"}) {
    if (file.Has(key)) file.FailAt(key, "needs raw_low and raw_high");
  }
  const std::string unit = UnitIn(file);
  if (unit == kVolts) file.FailAt("unit", "volts need raw_low and raw_high");
  const double sign = file.Number("sign", 1.0);
  if (std::abs(sign) != 1.0) file.FailAt("sign", "must be 1 or -1");
  const RecordedUnit known = *FindUnit(unit);
  return {.column = column,
          .channel = channel,
          .unit = known,
          .scale = sign * file.Number("scale", 1.0),
          .offset = file.Number("offset", 0.0),
          .bits = BitsIn(file, unit),
          .in_counts = known == RecordedUnit::kCounts};
}

/// Assumptions of a row: words of this list.
std::string AssumedIn(MapFile& file) {
  constexpr std::array<std::string_view, 5> kWords = {"joint", "unit", "sign", "range", "rate"};
  std::string text = file.Text("assumed", "");
  for (const std::string_view word : SplitCells(text, ' ')) {
    if (word.empty() || std::ranges::find(kWords, word) != kWords.end()) continue;
    file.FailAt("assumed",
                file.Quoted(std::string(word)) + " must be one of: joint, unit, sign, range, rate");
  }
  return text;
}

/// The window of an envelope, whose values at rest and at full activity are the two points.
void AddEnvelope(MapFile& file, ColumnMapping& mapping) {
  if (!file.Has("envelope_ms")) return;
  mapping.envelope_ms = file.Number("envelope_ms", 0.0);
  if (!(mapping.envelope_ms >= kShortestEnvelope_ms &&
        mapping.envelope_ms <= kLongestEnvelope_ms)) {
    file.FailAt("envelope_ms",
                fmt::format("must be from {} to {}", kShortestEnvelope_ms, kLongestEnvelope_ms));
  }
  if (!mapping.points) file.FailAt("envelope_ms", "needs raw_low and raw_high of the envelope");
  for (const std::string_view key : {"bits", "wraps_at"}) {
    if (file.Has(key)) file.FailAt(key, "must be empty beside envelope_ms");
  }
  mapping.in_counts = false;  // of the muscle, not of a bend sensor
}

/// The next row of the map, which is of `channel`.
void AddChannel(MapFile& file, std::size_t column, const std::string& channel, ColumnMap& map) {
  const auto index = FindChannel(channel);
  if (std::ranges::find(kRoles, channel) != kRoles.end()) {
    file.FailAt("channel",
                channel + " is of a log of commands and angles: gauntlet identify --map");
  }
  if (!index) {
    file.FailAt("channel", fmt::format("unknown channel {}{}", file.Quoted(channel),
                                       Suggestion(channel, KnownChannelNames())));
  }
  if (file.Has("joint")) file.FailAt("joint", "is for command, angle and motor");
  const bool two_points = file.Has("raw_low") || file.Has("raw_high");
  ColumnMapping mapping =
      two_points ? TwoPoint(file, column, *index) : OnePoint(file, column, *index);
  mapping.weight = file.Number("weight", 1.0);
  mapping.wraps_at = file.Number("wraps_at", 0.0);
  if (mapping.wraps_at < 0.0) file.FailAt("wraps_at", "must be above 0");
  mapping.assumed = AssumedIn(file);
  AddEnvelope(file, mapping);
  // Twice without a weight is a slip of the pen, not a sum.
  const auto before = std::ranges::find(map.channels, *index, &ColumnMapping::channel);
  if (before != map.channels.end() && !file.Has("weight")) {
    file.FailAt("channel", channel + " appears twice; its rows add up if each has a weight");
  }
  map.channels.push_back(mapping);
}

/// The next row of the map, which is of a log. Two points need their angles: a log's joint has no
/// range.
void AddPart(MapFile& file, std::size_t column, const std::string& role, LogMap& map) {
  if (std::ranges::find(kRoles, role) == kRoles.end()) {
    file.FailAt("channel", file.Quoted(role) +
                               " must be one of: time, command, angle, motor, ignore; its joint "
                               "stands in the key joint");
  }
  for (const std::string_view key : {"weight", "wraps_at", "envelope_ms"}) {
    if (file.Has(key)) file.FailAt(key, "is for a glove's channels, not for a log");
  }
  const bool two_points = file.Has("raw_low") || file.Has("raw_high");
  for (const std::string_view key : {"deg_low", "deg_high"}) {
    if (two_points && !file.Has(key)) file.FailAt(key, "must be given beside raw_low and raw_high");
  }
  const ColumnMapping mapping = two_points ? TwoPoint(file, column, 0) : OnePoint(file, column, 0);
  if (mapping.unit != RecordedUnit::kDegrees && mapping.unit != RecordedUnit::kRadians) {
    file.FailAt("unit",
                "of a log must be deg or rad; counts need raw_low, raw_high, deg_low, "
                "deg_high");
  }
  const double deg = mapping.unit == RecordedUnit::kRadians ? kDegPerRad : 1.0;
  map.parts.push_back({.column = column,
                       .role = role,
                       .part = file.Text("joint", ""),
                       .scale = deg * mapping.scale,
                       .offset_deg = deg * mapping.offset});
}

/// Treatment of rows whose column the recording does not have.
enum class MissingColumns { kFail, kLeaveOut };

std::optional<std::size_t> ColumnOf(const MapFile& map, const RecordingColumns& recording,
                                    MissingColumns missing) {
  const std::string name = map.Text("column", "");
  const auto& header = recording.header;
  auto found = std::ranges::find(header, name);
  if (!name.empty() && found != header.end()) return found - header.begin();
  const auto is_same = [&](const std::string& other) {
    return map.is_profile() && !BareName(name).empty() && IsSameName(name, other);
  };
  found = std::ranges::find_if(header, is_same);
  if (std::ranges::count_if(header, is_same) == 1) return found - header.begin();
  if (const auto number = controller::ParseWholeNumber(name, 1, recording.count)) {
    return *number - 1;
  }
  if (missing == MissingColumns::kLeaveOut) return std::nullopt;
  map.FailAt("column", fmt::format("{} has no column {}, must be one of its names or 1 to {}",
                                   recording.name, map.Quoted(name), recording.count));
}

/// Hands each row with a channel to `add`, as (column, channel). Errors: UserError for rows that
/// name no column.
template <class Add>
void ReadRows(MapFile& file, const RecordingColumns& recording, MissingColumns missing,
              std::vector<TimeMapping>& time, bool& is_confirmed, const Add& add) {
  bool any = false;
  while (file.NextRow()) {
    const std::string channel = file.Text("channel", "");
    if (file.Text("column", "") == kAllOfMap && channel == "confirmed") {
      is_confirmed = true;
      continue;
    }
    const std::optional<std::size_t> column = ColumnOf(file, recording, missing);
    if (channel == "ignore" || !column) continue;
    if (channel == "time") {
      AddTime(file, *column, time);
    } else {
      add(*column, channel);
      any = true;
    }
  }
  if (!any) file.FailAt("channel", "the map names no channel");
}

}  // namespace

std::string HandInText(std::string_view text) {
  for (const std::string& word : WordsOf(text)) {
    if (!SideOf(word).empty()) return std::string(SideOf(word));
  }
  return "";
}

std::optional<std::size_t> HandColumn(const TableLayout& layout) {
  for (std::size_t c = 0; c < layout.columns; ++c) {
    const bool names_hands =
        KindOf(layout, c) == CellKind::kText &&
        HasWordOf(WordsOf(layout.names[c]), "hand hands handedness side") &&
        std::ranges::all_of(layout.rows, [c](const std::vector<std::string>& row) {
          return !HandInText(row[c]).empty();
        });
    if (names_hands) return c;
  }
  return std::nullopt;
}

void KeepHand(const HandRows& hand, CsvReader& reader) {
  reader.KeepRows(hand.column,
                  [side = hand.side](std::string_view text) { return HandInText(text) == side; });
}

std::string AssumptionsOf(const ColumnMap& map) {
  if (map.is_confirmed) return "";
  std::vector<std::pair<std::string, std::string>> channels_by_words;
  for (const ColumnMapping& mapping : map.channels) {
    if (mapping.assumed.empty()) continue;
    const auto found = std::ranges::find(channels_by_words, mapping.assumed,
                                         &std::pair<std::string, std::string>::first);
    if (found == channels_by_words.end()) {
      channels_by_words.emplace_back(mapping.assumed, ChannelText(mapping));
    } else {
      found->second += ", " + ChannelText(mapping);
    }
  }
  std::string text;
  for (const auto& [words, channels] : channels_by_words) {
    const std::vector<std::string_view> parts = SplitCells(words, ' ');
    std::string listed;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      listed += i == 0 ? "" : i + 1 == parts.size() ? " and " : ", ";
      listed += parts[i];
    }
    text += fmt::format("{}{} of {}", text.empty() ? "assumed: " : "; ", listed, channels);
  }
  return text.empty() ? "" : text + " (to confirm: the row all,confirmed in the map)";
}

ColumnMap MapByHeader(const CsvReader& recording, ProblemHandling handling,
                      std::vector<std::string>& left_out, std::string_view unit) {
  if (recording.header().empty()) {
    recording.Fail(1, "the first line must name the columns, or a column map must be given");
  }
  constexpr std::size_t kRows = 200;
  // FirstRows() leaves the reader as it was.
  const auto rows = const_cast<CsvReader&>(recording).FirstRows(kRows, recording.row() + 2 * kRows);
  ColumnMap map;
  map.time = TimeByName(recording.name(), {.separator = recording.separator(),
                                           .columns = recording.column_count(),
                                           .names = recording.header(),
                                           .notes = {},
                                           .rows = rows});
  for (std::size_t column = 0; column < recording.column_count(); ++column) {
    const std::string& name = recording.header()[column];
    if (AddByName(name, column, unit, map)) continue;
    if (GoesOn(handling)) {
      left_out.push_back(name);
      continue;
    }
    recording.Fail(column + 1, fmt::format("unknown column {}{}", recording.Quoted(name),
                                           Suggestion(name, KnownChannelNames())));
  }
  if (const auto twice = Repeated(map)) {
    recording.Fail(twice->column + 1, fmt::format("{} appears twice", ChannelText(*twice)));
  }
  if (map.channels.empty()) recording.Fail(1, "there is no column of a channel");
  return map;
}

ColumnMap ReadColumnMap(const std::filesystem::path& path, const CsvReader& recording) {
  return ReadColumnMap(path, {.name = recording.name(),
                              .header = recording.header(),
                              .count = recording.column_count(),
                              .may_choose_rows = true});
}

namespace {

ColumnMap ReadMap(MapFile file, const RecordingColumns& recording, MissingColumns missing) {
  ColumnMap map;
  ReadRows(file, recording, missing, map.time, map.is_confirmed,
           [&](std::size_t column, const std::string& channel) {
             if (channel != "left" && channel != "right") {
               AddChannel(file, column, channel, map);
               return;
             }
             if (!recording.may_choose_rows) {
               file.FailAt("channel", "rows of one hand are taken of recordings only");
             }
             if (map.hand) file.FailAt("channel", "one column alone may name the hand");
             map.hand = {column, channel};
           });
  if (map.channels.empty()) file.FailAt("channel", "the map names no channel");
  return map;
}

}  // namespace

ColumnMap ReadColumnMap(const std::filesystem::path& path, const RecordingColumns& recording) {
  return ReadMap(OpenMap(path), recording, MissingColumns::kFail);
}

ColumnMap MapOfProfile(const Profile& profile, const RecordingColumns& recording) {
  return ReadMap(MapFile(profile.name, TextSource(profile.map), true), recording,
                 MissingColumns::kLeaveOut);
}

LogMap ReadLogMap(const std::filesystem::path& path, const RecordingColumns& recording) {
  MapFile file = OpenMap(path);
  LogMap map;
  bool is_confirmed = false;
  ReadRows(file, recording, MissingColumns::kFail, map.time, is_confirmed,
           [&](std::size_t column, const std::string& role) { AddPart(file, column, role, map); });
  return map;
}

}  // namespace gauntlet::sim
