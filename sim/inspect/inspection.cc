#include "sim/inspect/inspection.h"

#include <fmt/format.h>

#include <algorithm>
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

/// Takes over the guessed time columns if their time advances.
void TakeTime(const TimeGuess& guess, const TimeStatistics& time, Inspection& inspection) {
  inspection.has_time = !guess.parts.empty() && std::isfinite(time.rate_hz);
  inspection.rate_is_known = inspection.has_time;
  inspection.time_why = guess.parts.empty() || inspection.has_time
                            ? guess.why
                            : "its column has no two rows at different times";
  if (!inspection.has_time) return;
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

/// Common range of all sensors, without the rarest values.
struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  bool is_whole = true;
};

RawUnit UnitByNames(const std::vector<std::size_t>& sensors, const Inspection& inspection) {
  std::size_t degrees = 0, radians = 0, volts = 0, counts = 0;
  for (const std::size_t c : sensors) {
    const std::vector<std::string> words = WordsOf(inspection.columns[c].name);
    const auto has = [&words](std::initializer_list<const char*> any) {
      return std::ranges::any_of(
          any, [&](const char* word) { return std::ranges::find(words, word) != words.end(); });
    };
    degrees += has({"deg", "degree", "degrees"}) ? 1 : 0;
    radians += has({"rad", "radian", "radians"}) ? 1 : 0;
    volts += has({"v", "volt", "volts", "voltage"}) ? 1 : 0;
    counts += has({"counts", "count", "adc", "raw"}) ? 1 : 0;
  }
  if (2 * degrees > sensors.size()) return RawUnit::kDegrees;
  if (2 * radians > sensors.size()) return RawUnit::kRadians;
  if (2 * volts > sensors.size()) return RawUnit::kVolts;
  if (2 * counts > sensors.size()) return RawUnit::kCounts;
  return RawUnit::kUnknown;
}

int BitsFor(double high) {
  for (const int bits : {8, 10, 12, 14, 16, 24}) {
    if (high < std::ldexp(1.0, bits)) return bits;
  }
  return 32;
}

/// Guesses one unit for all sensors: a glove has only one.
void GuessUnit(const std::vector<std::size_t>& sensors, Inspection& inspection) {
  Range range;
  std::size_t around_zero = 0;  // columns with both signs, or with values near zero
  for (const std::size_t c : sensors) {
    const ColumnStatistics& column = inspection.columns[c].statistics;
    range.low = std::min(range.low, column.usual_low);
    range.high = std::max(range.high, column.usual_high);
    range.is_whole = range.is_whole && column.is_whole;
    const double reach = std::max(std::abs(column.usual_low), std::abs(column.usual_high));
    around_zero += column.usual_low < 0.1 * reach ? 1 : 0;
  }
  const double reach = std::max(std::abs(range.low), std::abs(range.high));
  const bool near_zero = 2 * around_zero > sensors.size();
  const std::string numbers =
      fmt::format("{} from {:.4g} to {:.4g}", range.is_whole ? "whole numbers" : "numbers",
                  range.low, range.high);
  const auto is = [&](RawUnit unit, std::string_view why) {
    inspection.unit = unit;
    inspection.unit_why = numbers + std::string(why);
  };
  if (const RawUnit named = UnitByNames(sensors, inspection); named != RawUnit::kUnknown) {
    is(named, ", and the names say so");
  } else if (range.is_whole && reach > 1.0 &&
             (reach > 180.0 || (range.low > 20.0 && reach > 100.0))) {
    is(RawUnit::kCounts, ", more than an angle has");
  } else if (range.is_whole && reach > 4.0) {
    is(RawUnit::kDegrees, ", as many as a joint has degrees");
  } else if (range.low >= -0.01 && range.high <= 1.01) {
    is(RawUnit::kShare, ", within 0 and 1");
  } else if (range.low >= -0.01 && range.high <= 5.3 && !near_zero) {
    is(RawUnit::kVolts, ", away from zero as a voltage divider is");
  } else if (reach <= std::numbers::pi) {
    is(RawUnit::kRadians, ", no more than half a turn in radians");
  } else if (range.low >= -0.01 && range.high <= 5.3) {
    is(RawUnit::kVolts, ", more than radians, less than degrees");
  } else if (reach <= 200.0) {
    is(RawUnit::kDegrees, ", what joints have in degrees");
  } else {
    is(RawUnit::kCounts, ", beyond what an angle has");
  }
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
  switch (sensors) {
    case 5:
      return "flex5";
    case 14:
      return "5dt14";
    case 18:
      return "cyberglove18";
    case 20:
      return "manus20";
    case 22:
      return "cyberglove22";
    default:
      return "";
  }
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
    std::vector<std::string> order;
    if (preset.empty()) {
      order = GloveChannelNames();
    } else {
      order = ChannelsOfPreset(preset);
    }
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
  switch (unit) {
    case RawUnit::kCounts:
      return "counts";
    case RawUnit::kShare:
      return "share";
    case RawUnit::kDegrees:
      return "deg";
    case RawUnit::kRadians:
      return "rad";
    case RawUnit::kVolts:
      return "volts";
    case RawUnit::kUnknown:
      break;
  }
  return "unknown";
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
  TakeTime(time, statistics.Time(), inspection);
  if (!inspection.has_time) {
    constexpr double kAssumedRateHz = 50.0;
    inspection.rate_is_known = options.rate_hz > 0.0;
    inspection.time.rate_hz = inspection.rate_is_known ? options.rate_hz : kAssumedRateHz;
    inspection.time.duration_s = static_cast<double>(inspection.rows) / inspection.time.rate_hz;
  }
  KeepPicture(statistics, inspection);
  const std::vector<std::size_t> sensors = FindSensors(inspection);
  if (sensors.empty()) return inspection;
  GuessChannels(sensors, options.preset, inspection);
  GuessUnit(inspection.MappedColumns(), inspection);
  GuessSigns(inspection);
  return inspection;
}

}  // namespace gauntlet::sim
