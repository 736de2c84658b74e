#include "sim/inspect/inspection.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>

#include "sim/base/channels.h"
#include "sim/base/error.h"
#include "sim/base/signal.h"
#include "sim/inspect/joint_names.h"
#include "sim/inspect/time_guess.h"
#include "sim/recordings/column_map.h"
#include "sim/recordings/csv_reader.h"
#include "sim/recordings/table_source.h"
#include "sim/recordings/time_columns.h"

namespace gauntlet::sim {
namespace {

/// The beginning of a source, cut at the end of a line. `is_whole` becomes false if the source has
/// more.
CsvReader::Source BeginningOf(CsvReader::Source source, const std::shared_ptr<bool>& is_whole) {
  return [source = std::move(source), is_whole, given = std::uintmax_t{0}](
             char* buffer, std::size_t size) mutable -> std::size_t {
    if (!*is_whole) return 0;
    const std::size_t got = source(buffer, size);
    given += got;
    if (given < kMostInspectedBytes) return got;
    *is_whole = false;
    const std::string_view text(buffer, got);
    return std::min(text.rfind('\n'), got - 1) + 1;
  };
}

/// Reads the whole table once.
TableStatistics ReadTable(const TimeGuess& time, const std::vector<InspectedColumn>& columns,
                          CsvReader& csv) {
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (columns[c].kind == CellKind::kText) csv.Ignore(c);
    if (columns[c].kind == CellKind::kTime) csv.ReadAsTime(c);
  }
  TableStatistics statistics(csv.column_count());
  std::vector<double> values(csv.column_count());
  while (csv.NextRow(values)) {
    double time_s = time.parts.empty() ? kNaN : 0.0;
    for (const TimePart& part : time.parts) time_s += values[part.column] * SecondsPer(part.unit);
    statistics.Add(time_s, values);
  }
  return statistics;
}

/// Takes over the guessed time columns if their time advances. Otherwise the rate is the given one
/// (0: none), or an assumption.
void TakeTime(const TimeGuess& guess, const TimeStatistics& time, double given_rate_hz,
              Inspection& inspection) {
  inspection.has_time = !guess.parts.empty() && std::isfinite(time.rate_hz);
  inspection.rate_is_known = inspection.has_time;
  inspection.time_why = guess.parts.empty() || inspection.has_time
                            ? guess.why
                            : "its column has no two rows at different times";
  if (!inspection.has_time) {
    constexpr double kAssumedRateHz = 50.0;
    inspection.rate_is_known = given_rate_hz > 0.0;
    inspection.time.rate_hz = inspection.rate_is_known ? given_rate_hz : kAssumedRateHz;
    inspection.time.duration_s = static_cast<double>(inspection.rows) / inspection.time.rate_hz;
    return;
  }
  inspection.time = time;
  for (const TimePart& part : guess.parts) {
    inspection.columns.at(part.column).time_unit = part.unit;
  }
}

constexpr double kBeyondCounts = 4294967296.0;  // 2^32

/// Columns that may be sensors of a hand.
std::vector<std::size_t> FindSensors(Inspection& inspection) {
  std::vector<std::size_t> sensors;
  for (std::size_t c = 0; c < inspection.columns.size(); ++c) {
    InspectedColumn& column = inspection.columns[c];
    if (!column.time_unit.empty()) continue;
    const ColumnStatistics& statistics = column.statistics;
    if (column.kind != CellKind::kNumber) {
      column.why = column.kind == CellKind::kText ? "text" : "a time, which another column has";
    } else if (statistics.good_rows == 0) {
      column.why = "empty";
    } else if (IsSampleNumber(column.name) || TimeScaleS(column.name) ||
               (statistics.is_rising && statistics.is_whole && statistics.low < statistics.high)) {
      column.why = "it counts the rows, or is another time";
    } else if (const std::string other = NoSensor(column.name); !other.empty()) {
      column.why = "by its name " + other;
    } else if (std::max(std::abs(statistics.usual_low), std::abs(statistics.usual_high)) >=
               kBeyondCounts) {
      column.why = "numbers beyond 32 bits, which no converter has";
    } else if (statistics.low == statistics.high && ReadSensorName(column.name).finger.empty()) {
      column.why = "it never moves";
    } else {
      sensors.push_back(c);
    }
  }
  return sensors;
}

/// The unit that more than half of the names have.
RawUnit UnitByNames(const std::vector<std::size_t>& sensors, const Inspection& inspection) {
  constexpr std::array<Meaning, 4> kUnitNames = {{{"deg", "deg degree degrees"},
                                                  {"rad", "rad radian radians"},
                                                  {"volts", "v volt volts voltage"},
                                                  {"counts", "counts count adc raw"}}};
  for (const RawUnit unit :
       {RawUnit::kDegrees, RawUnit::kRadians, RawUnit::kVolts, RawUnit::kCounts}) {
    const auto is_named = [&](std::size_t c) {
      return std::ranges::any_of(WordsOf(inspection.columns[c].name), [&](const std::string& word) {
        return MeaningOf(kUnitNames, word) == NameOf(unit);
      });
    };
    if (2 * std::ranges::count_if(sensors, is_named) > std::ssize(sensors)) return unit;
  }
  return RawUnit::kUnknown;
}

int BitsFor(double high) {
  for (const int bits : {8, 10, 12, 14, 16, 24}) {
    if (high < std::ldexp(1.0, bits)) return bits;
  }
  return 32;
}

/// Common range of all sensors, without the rarest values.
struct CommonRange {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  bool is_whole = true;
  bool is_near_zero = false;  // most columns have both signs, or values near zero
  double reach = 0.0;         // largest magnitude
};

CommonRange RangeOf(const std::vector<std::size_t>& sensors, const Inspection& inspection) {
  CommonRange range;
  std::size_t near_zero = 0;
  for (const std::size_t c : sensors) {
    const ColumnStatistics& column = inspection.columns[c].statistics;
    range.low = std::min(range.low, column.usual_low);
    range.high = std::max(range.high, column.usual_high);
    range.is_whole = range.is_whole && column.is_whole;
    const double reach = std::max(std::abs(column.usual_low), std::abs(column.usual_high));
    near_zero += column.usual_low < 0.1 * reach ? 1 : 0;
  }
  range.is_near_zero = 2 * near_zero > sensors.size();
  range.reach = std::max(std::abs(range.low), std::abs(range.high));
  return range;
}

struct UnitGuess {
  bool fits;
  RawUnit unit;
  std::string_view why;
};

/// Guesses one unit for all sensors: a glove has only one. The first guess that fits counts.
void GuessUnit(const std::vector<std::size_t>& sensors, Inspection& inspection) {
  constexpr double kMostVolts = 5.3;  // a supply of 5 V and its tolerance
  const CommonRange range = RangeOf(sensors, inspection);
  const RawUnit named = UnitByNames(sensors, inspection);
  const bool is_count = range.reach > 180.0 || (range.low > 20.0 && range.reach > 100.0);
  const bool is_voltage = range.low >= -0.01 && range.high <= kMostVolts;
  const bool is_share = range.low >= -0.01 && range.high <= 1.01;
  const UnitGuess guesses[] = {
      {named != RawUnit::kUnknown, named, ", and the names say so"},
      {range.is_whole && is_count, RawUnit::kCounts, ", more than an angle has"},
      {range.is_whole && range.reach > 4.0, RawUnit::kDegrees, ", as many as a joint has degrees"},
      {is_share, RawUnit::kShare, ", within 0 and 1"},
      {is_voltage && !range.is_near_zero, RawUnit::kVolts,
       ", away from zero as a voltage divider is"},
      {range.reach <= std::numbers::pi, RawUnit::kRadians, ", no more than half a turn in radians"},
      {is_voltage, RawUnit::kVolts, ", more than radians, less than degrees"},
      {range.reach <= 200.0, RawUnit::kDegrees, ", what joints have in degrees"},
      {true, RawUnit::kCounts, ", beyond what an angle has"}};
  const UnitGuess& guess = *std::ranges::find(guesses, true, &UnitGuess::fits);
  inspection.unit = guess.unit;
  inspection.unit_why =
      fmt::format("{} from {:.4g} to {:.4g}{}", range.is_whole ? "whole numbers" : "numbers",
                  range.low, range.high, guess.why);
  if (inspection.unit == RawUnit::kCounts) inspection.bits = BitsFor(range.high);
}

/// The channels of a preset by sensor number; empty for sensors that drive no joint.
std::vector<std::string> ChannelsOfPreset(const std::string& preset) {
  const std::filesystem::path file = FileOfMap(preset);
  CsvReader csv(file.string(), FileSource(file), ProblemHandling::kAllowMissing);
  std::vector<std::string> cells;
  std::vector<std::string> channels;
  while (csv.NextRow(cells)) {
    const auto number = static_cast<std::size_t>(csv.Number(cells.front(), 1));
    if (number < 1 || number > 1000) csv.Fail(1, "must be the number of a sensor");
    channels.resize(std::max(channels.size(), number));
    if (cells[1] != "ignore" && channels[number - 1].empty()) channels[number - 1] = cells[1];
  }
  return channels;
}

/// The preset with this number of sensors; empty if there is none.
std::string PresetFor(std::size_t sensors) {
  static const std::map<std::size_t, std::string> kPresets = {
      {5, "flex5"}, {14, "5dt14"}, {18, "cyberglove18"}, {20, "manus20"}, {22, "cyberglove22"}};
  const auto found = kPresets.find(sensors);
  return found == kPresets.end() ? "" : found->second;
}

void GuessChannels(const std::vector<std::size_t>& sensors, const std::string& asked,
                   Inspection& inspection) {
  std::vector<std::string> names;
  for (const std::size_t c : sensors) names.push_back(inspection.columns[c].name);
  std::vector<std::string> why;
  std::vector<std::string> channels = ChannelsByNames(names, why);
  const auto is_named = [](const std::string& channel) { return !channel.empty(); };
  const bool are_named = std::ranges::any_of(channels, is_named);
  if (!asked.empty() || !are_named) {
    const std::string preset = asked.empty() ? PresetFor(sensors.size()) : asked;
    const std::vector<std::string> order =
        preset.empty() ? GloveChannelNames() : ChannelsOfPreset(preset);
    for (std::size_t i = 0; i < sensors.size(); ++i) {
      channels[i] = i < order.size() ? order[i] : "";
      why[i] = preset.empty() ? "in the order of gauntlet list channels (assumption)"
                              : "in the order of " + preset +
                                    (asked.empty() ? ", by their number (assumption)" : "");
      if (channels[i].empty()) why[i] = "no joint is left for it " + why[i];
    }
  }
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    InspectedColumn& column = inspection.columns[sensors[i]];
    column.channel = channels[i];
    column.why = why[i].empty() ? "its name says no joint" : why[i];
  }
}

/// Marks angles as inverted if they fall while the joint bends: nearly all values are negative,
/// although the joint bends mainly to the positive side.
void GuessSigns(Inspection& inspection) {
  for (InspectedColumn& column : inspection.columns) {
    if (column.channel.empty()) continue;
    const Channel& joint = KnownChannels()[ChannelIndex(column.channel)];
    const double middle = column.statistics.usual_low + column.statistics.usual_high;
    const bool is_angle =
        inspection.unit == RawUnit::kDegrees || inspection.unit == RawUnit::kRadians;
    const double far_deg = 0.1 * (inspection.unit == RawUnit::kRadians ? kRadPerDeg : 1.0) *
                           (joint.max_deg - joint.min_deg);
    if (!is_angle || joint.max_deg < -joint.min_deg + 20.0 || middle > -far_deg) continue;
    column.is_inverted = true;
    column.why += "; bends downwards";
  }
}

void KeepPicture(const TableStatistics& statistics, Inspection& inspection) {
  inspection.picture_time_s = statistics.kept_times_s();
  for (std::size_t c = 0; c < inspection.columns.size(); ++c) {
    inspection.picture_values.push_back(inspection.columns[c].kind == CellKind::kNumber
                                            ? statistics.KeptValues(c)
                                            : std::vector<double>());
  }
  if (inspection.has_time) return;
  const double period_s = static_cast<double>(statistics.kept_every()) / inspection.time.rate_hz;
  for (std::size_t i = 0; i < inspection.picture_time_s.size(); ++i) {
    inspection.picture_time_s[i] = static_cast<double>(i) * period_s;
  }
}

}  // namespace

std::string_view NameOf(RawUnit unit) {
  constexpr std::array<std::string_view, 6> kNames = {"counts", "share", "deg",
                                                      "rad",    "volts", "unknown"};
  return kNames[static_cast<std::size_t>(unit)];
}

std::vector<std::size_t> Inspection::MappedColumns() const {
  std::vector<std::size_t> mapped;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (!columns[c].channel.empty()) mapped.push_back(c);
  }
  return mapped;
}

Inspection Inspect(const std::filesystem::path& file, const InspectionOptions& options) {
  Inspection inspection;
  inspection.file = file.string();
  inspection.format = FormatOfFile(file);
  inspection.file_bytes = std::filesystem::file_size(file);
  inspection.array = options.array;
  inspection.arrays = ArraysIn(file, options.array);
  const auto is_whole = std::make_shared<bool>(true);
  auto [layout, reader] =
      FindTable(file.string(), BeginningOf(TableSource(file, options.array), is_whole),
                [&inspection](RecordingProblem problem, std::size_t) {
                  ++inspection.problems[std::string(NameOf(problem))];
                });
  inspection.layout = std::move(layout);
  inspection.columns.resize(inspection.layout.columns);
  for (std::size_t c = 0; c < inspection.columns.size(); ++c) {
    inspection.columns[c].name = inspection.layout.names[c];
    inspection.columns[c].kind = KindOf(inspection.layout, c);
  }
  const TimeGuess time = GuessTime(inspection.layout);
  const TableStatistics statistics = ReadTable(time, inspection.columns, reader);
  inspection.is_whole = *is_whole;
  inspection.rows = statistics.rows();
  for (std::size_t c = 0; c < inspection.columns.size(); ++c) {
    if (inspection.columns[c].kind == CellKind::kNumber) {
      inspection.columns[c].statistics = statistics.Column(c);
    }
  }
  TakeTime(time, statistics.Time(), options.rate_hz, inspection);
  KeepPicture(statistics, inspection);
  const std::vector<std::size_t> sensors = FindSensors(inspection);
  if (sensors.empty()) return inspection;
  GuessChannels(sensors, options.preset, inspection);
  GuessUnit(inspection.MappedColumns(), inspection);
  GuessSigns(inspection);
  return inspection;
}

}  // namespace gauntlet::sim
