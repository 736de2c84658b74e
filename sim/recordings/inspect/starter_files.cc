#include "sim/recordings/inspect/starter_files.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "sim/base/channels.h"
#include "sim/base/error.h"
#include "sim/base/signal.h"
#include "sim/base/text.h"
#include "sim/recordings/inspect/health.h"

namespace gauntlet::sim {
namespace {

/// The column's name if it is valid in a map and unique, else its number.
std::string ColumnText(const Inspection& inspection, std::size_t column) {
  const std::string& name = inspection.layout.names[column];
  const bool is_plain = LooksLikeKey(name) && std::ranges::any_of(name, [](unsigned char letter) {
                          return std::isalpha(letter) != 0;
                        });
  const bool is_only = std::ranges::count(inspection.layout.names, name) == 1;
  if (inspection.layout.has_header && is_plain && is_only) return name;
  return std::to_string(column + 1);
}

/// Two values, with as many digits as tell them apart.
std::string TwoValues(double low, double high) {
  if (std::abs(high - low) < 1e-3 * std::max(std::abs(low), std::abs(high))) {
    return fmt::format("{},{}", low, high);
  }
  return fmt::format("{:.6g},{:.6g}", low, high);
}

/// The keys of a row that give the angle, without a comma behind: unit to deg_high.
std::string AngleCells(const Inspection& inspection, const InspectedColumn& column,
                       const Channel* joint) {
  const std::string ends_deg =
      joint == nullptr ? "," : fmt::format("{:g},{:g}", LowDegOf(*joint), joint->max_deg);
  // The whole range would let 0 mean a knuckle that is bent back, not a straight finger.
  if (inspection.unit == RawUnit::kShare) {
    return fmt::format("deg,,0,{},{}", inspection.unit_high > 1.5 ? 100 : 1, ends_deg);
  }
  if (!NeedsTwoPoints(inspection.unit)) {
    return fmt::format("{},{},,,,", inspection.unit == RawUnit::kDegrees ? "deg" : "rad",
                       column.is_inverted ? "-1" : "1");
  }
  const double low = column.statistics.usual_low;
  double high = column.statistics.usual_high;
  if (!(high > low)) high = low + std::max(1.0, 1e-3 * std::abs(low));
  return fmt::format(
      "{},,{},{}",
      NameOf(inspection.unit == RawUnit::kUnknown ? RawUnit::kCounts : inspection.unit),
      TwoValues(low, high), ends_deg);
}

/// AngleCells() of a row of a profile.
std::string MappedCells(const Inspection& inspection, const InspectedColumn& column,
                        const ColumnMapping& mapping) {
  const Channel& joint = KnownChannels()[static_cast<std::size_t>(mapping.channel)];
  if (TakesRangeOfFile(mapping)) return AngleCells(inspection, column, &joint);
  if (mapping.points) {
    const auto deg_at = [&](double raw) { return mapping.scale * raw + mapping.offset; };
    return fmt::format("{},,{},{:g},{:g}", mapping.in_counts ? "counts" : "deg",
                       TwoValues(mapping.points->low, mapping.points->high),
                       deg_at(mapping.points->low), deg_at(mapping.points->high));
  }
  const bool is_share = mapping.unit == RecordedUnit::kShare;
  const bool is_rad = mapping.unit == RecordedUnit::kRadians;
  return fmt::format("{},{},,,,",
                     is_share ? "share"
                     : is_rad ? "rad"
                              : "deg",
                     mapping.scale < 0.0 ? "-1" : "1");
}

/// True if the recorded counts reach the controllers: see OwnCountsOf.
bool HasOwnCounts(const Inspection& inspection) {
  return inspection.unit == RawUnit::kCounts &&
         std::ranges::all_of(inspection.MappedColumns(), [&](std::size_t c) {
           const InspectedColumn& column = inspection.columns[c];
           return column.statistics.usual_low >= 0.0 &&
                  std::ranges::all_of(column.mappings, &ColumnMapping::in_counts);
         });
}

bool HasEnvelopes(const Inspection& inspection) {
  return std::ranges::any_of(
      inspection.columns, [](const InspectedColumn& column) { return column.envelope_ms > 0.0; });
}

/// A key that only some maps have, and its value in a row; empty where it says nothing.
struct MoreKey {
  std::string_view key;
  std::string (*value)(const Inspection& inspection, const InspectedColumn& column,
                       const ColumnMapping* mapping);
};

std::string NumberUnless(double value, double usual) {
  return value == usual ? "" : fmt::format("{:g}", value);
}

constexpr MoreKey kMoreKeys[] = {
    {"scale",
     [](const Inspection& inspection, const InspectedColumn&, const ColumnMapping* mapping) {
       const bool is_mrad = inspection.unit == RawUnit::kMilliradians;
       if (mapping == nullptr) return NumberUnless(is_mrad ? kRadPerMilliradian : 1.0, 1.0);
       return mapping->points ? "" : NumberUnless(std::abs(mapping->scale), 1.0);
     }},
    {"offset",
     [](const Inspection&, const InspectedColumn& column, const ColumnMapping* mapping) {
       if (mapping != nullptr) return mapping->points ? "" : NumberUnless(mapping->offset, 0.0);
       return column.added != 0.0 ? fmt::format("{:.9g}", column.added) : std::string();
     }},
    {"bits",
     [](const Inspection& inspection, const InspectedColumn&, const ColumnMapping* mapping) {
       const int bits = mapping != nullptr                    ? mapping->bits
                        : inspection.unit == RawUnit::kCounts ? inspection.bits
                                                              : 0;
       return bits == 0 || bits > kMostMapBits ? std::string() : fmt::to_string(bits);
     }},
    {"weight",
     [](const Inspection&, const InspectedColumn&, const ColumnMapping* mapping) {
       return mapping == nullptr ? "" : NumberUnless(mapping->weight, 1.0);
     }},
    {"wraps_at",
     [](const Inspection&, const InspectedColumn& column, const ColumnMapping* mapping) {
       if (mapping != nullptr) return NumberUnless(mapping->wraps_at, 0.0);
       return std::string(column.is_turning ? "360" : "");
     }},
    {"envelope_ms",
     [](const Inspection&, const InspectedColumn& column, const ColumnMapping* mapping) {
       return NumberUnless(mapping == nullptr ? column.envelope_ms : mapping->envelope_ms, 0.0);
     }},
};

/// Mappings of a column; one that is null where its unit says all.
std::vector<const ColumnMapping*> MappingsOf(const InspectedColumn& column) {
  std::vector<const ColumnMapping*> mappings;
  for (const ColumnMapping& mapping : column.mappings) mappings.push_back(&mapping);
  if (mappings.empty()) mappings.push_back(nullptr);
  return mappings;
}

/// True for a column that may drive a joint: one of numbers that is not the time.
bool MayDrive(const InspectedColumn& column) {
  using enum Quantity;
  return column.kind == CellKind::kNumber && !column.is_time && column.quantity != kTime &&
         column.quantity != kNothing && column.quantity != kText;
}

/// True for a column with a row in the map: the time, and sensors that move. While a question is
/// open, all that may be an answer.
bool IsRow(const Inspection& inspection, const InspectedColumn& column) {
  if (!column.time_unit.empty()) return true;
  if (column.is_sensor && !column.is_dead) return true;
  return !inspection.question.empty() && inspection.remedy == Remedy::kPresetOrMap &&
         MayDrive(column);
}

/// Those of kMoreKeys that a row of the map uses.
std::vector<const MoreKey*> MoreKeys(const Inspection& inspection) {
  std::vector<const MoreKey*> keys;
  for (const MoreKey& key : kMoreKeys) {
    const bool is_used = std::ranges::any_of(inspection.columns, [&](const InspectedColumn& is) {
      return is.is_sensor && !is.is_dead &&
             std::ranges::any_of(MappingsOf(is), [&](const ColumnMapping* mapping) {
               return !key.value(inspection, is, mapping).empty();
             });
    });
    if (is_used) keys.push_back(&key);
  }
  return keys;
}

/// The rows of a column in the map: one for each joint. A sensor that drives none is ignored.
std::string MapRows(const Inspection& inspection, std::size_t c,
                    const std::vector<const MoreKey*>& keys) {
  const InspectedColumn& column = inspection.columns[c];
  const std::string name = ColumnText(inspection, c);
  if (!column.time_unit.empty()) {
    return fmt::format("{},time,{},,,,,,{}\n", name, column.time_unit,
                       std::string(keys.size(), ','));
  }
  std::string rows;
  for (const ColumnMapping* mapping : MappingsOf(column)) {
    const bool has_joint = !column.channel.empty();
    const Channel* joint = mapping != nullptr
                               ? &KnownChannels()[static_cast<std::size_t>(mapping->channel)]
                           : has_joint ? &KnownChannels()[ChannelIndex(column.channel)]
                                       : nullptr;
    rows += fmt::format("{},{},{},{}", name, joint == nullptr ? "ignore" : joint->name,
                        mapping == nullptr ? AngleCells(inspection, column, joint)
                                           : MappedCells(inspection, column, *mapping),
                        AssumedOf(inspection, column));
    for (const MoreKey* key : keys) rows += "," + key->value(inspection, column, mapping);
    rows += "\n";
  }
  return rows;
}

/// Settings of filters in counts: r is the median of the channels' noise, at least the
/// quantisation noise. Counts are those of the recording, else of 10 bits over the joint's range.
/// The filters do not depend on the counts: q is proportional to r, and beta to 1 / counts.
struct FilterSettings {
  double r = 0.0;
  double q = 0.0;
  double beta = 0.0;  // of one_euro
};

FilterSettings SettingsInCounts(const Inspection& inspection, double glove_hz) {
  constexpr double kCountsPerRange = 0.8 * 1023.0;
  constexpr double kMostBeta = 1e9;  // of the key; counts of a tiny range reach it
  struct Noise {
    double variance;   // counts^2 of 10 bits
    double per_count;  // counts of 10 bits per count of the controllers
  };
  std::vector<Noise> noises;
  for (const std::size_t c : inspection.MappedColumns()) {
    const ColumnStatistics& column = inspection.columns[c].statistics;
    const Channel& joint = KnownChannels()[ChannelIndex(inspection.columns[c].channel)];
    const double per_unit = kCountsPerRange / (joint.max_deg - joint.min_deg) *
                            DegPerUnitOf(inspection, inspection.columns[c]);
    const double noise = std::max(column.noise, column.step / std::sqrt(12.0)) * per_unit;
    noises.push_back({noise * noise, HasOwnCounts(inspection) ? per_unit : 1.0});
  }
  std::ranges::sort(noises, {}, &Noise::variance);
  const Noise& median = noises[noises.size() / 2];
  const double scale = 1.0 / (median.per_count * median.per_count);
  return {.r = scale * std::clamp(median.variance, 0.1, 1e4),
          .q = scale * 10.0 / glove_hz,
          .beta = std::min(kMostBeta, 0.03 * median.per_count)};
}

/// Rate of the scenario's glove: that of the recording, within the limits of a glove.
double GloveRateHz(const Inspection& inspection) {
  return std::clamp(inspection.time.rate_hz, 10.0, 1000.0);
}

/// The mapped channels in the order of the hand's.
std::vector<std::string> MappedChannels(const Inspection& inspection) {
  std::vector<std::string> names;
  for (const Channel& channel : KnownChannels()) {
    const bool is_mapped = std::ranges::any_of(inspection.MappedColumns(), [&](std::size_t c) {
      const InspectedColumn& column = inspection.columns[c];
      return column.channel == channel.name ||
             std::ranges::any_of(column.mappings, [&](const ColumnMapping& mapping) {
               return KnownChannels()[static_cast<std::size_t>(mapping.channel)].name ==
                      channel.name;
             });
    });
    if (is_mapped) names.emplace_back(channel.name);
  }
  return names;
}

/// Settings of the motion that depend on what was found in the recording.
std::string MotionSettings(const Inspection& inspection, double glove_hz) {
  constexpr double kLongest_s = 600.0;  // a comparison then takes minutes
  constexpr double kSmoothingHz = 5.0;
  constexpr double kShortestGap_ms = 100.0;
  constexpr double kLongestGap_ms = 1e7;  // upper limit of the setting
  const TimeStatistics& time = inspection.time;
  std::string text;
  const auto add = [&text](std::string_view key, const std::string& value,
                           const std::string& remark = "") {
    text += fmt::format("    {}: {}{}{}\n", key, value, remark.empty() ? "" : "  # ", remark);
  };
  if (!inspection.array.empty()) add("array", YamlText(inspection.array));
  if (const int lines = inspection.layout.skipped_lines; lines > 0) {
    add("skip_lines", std::to_string(lines));
  }
  if (!inspection.has_time) {
    add("file_rate_hz", fmt::format("{:.6g}", time.rate_hz),
        inspection.rate_is_known ? "" : "assumed: " + inspection.time_why);
  }
  add("use", "measured");
  add("problems", "repair");
  // A gap must exceed the file's own jitter.
  const double gap_ms =
      std::clamp(std::max(3e3 / time.rate_hz, 2.0 * time.long_ms), kShortestGap_ms, kLongestGap_ms);
  if (gap_ms > kShortestGap_ms) add("longest_gap_ms", fmt::format("{:.4g}", gap_ms));
  if (time.duration_s > kLongest_s) {
    add("duration_s", fmt::format("{:g}", kLongest_s), fmt::format("of {:.5g}", time.duration_s));
  }
  if (glove_hz < 5.0 * kSmoothingHz) add("smoothing_hz", fmt::format("{:.3g}", 0.2 * glove_hz));
  return text;
}

/// The comments above the table of a map.
std::string HeadOfMap(const Inspection& inspection) {
  std::string map = fmt::format(
      "# Written by gauntlet inspect. Language: docs/reference/column-maps.md.\n# unit: {}{} "
      "({})\n",
      NameOf(inspection.unit), inspection.unit_is_assumed ? ", assumed" : "", inspection.unit_why);
  if (!inspection.profile.empty()) map += fmt::format("# profile: {}\n", inspection.profile);
  if (!inspection.question.empty()) {
    map += fmt::format("# Open: {}.\n", inspection.question);
  }
  if (!inspection.question.empty() && inspection.remedy == Remedy::kPresetOrMap) {
    map +=
        "# Write a channel of gauntlet list channels in place of ignore, and give this file as "
        "--map.\n";
  }
  if (HasEnvelopes(inspection)) {
    map +=
        "# raw_low, raw_high: lowest and highest usual values of the envelope, assumed to be rest "
        "and\n"
        "# full activity. Replace them by those of the wearer.\n";
  } else if (NeedsTwoPoints(inspection.unit)) {
    map +=
        "# raw_low, raw_high: lowest and highest usual values, assumed to be a straight and a "
        "bent\n"
        "# joint. Replace them by the values at two known angles. A falling sensor has raw_low "
        "above\n"
        "# raw_high.\n";
  }
  return map;
}

}  // namespace

std::string AssumedOf(const Inspection& inspection, const InspectedColumn& column) {
  std::string words;
  const auto add = [&words](bool is_assumed, const char* word) {
    if (is_assumed) words += (words.empty() ? "" : " ") + std::string(word);
  };
  const bool is_mapped = !column.mappings.empty();
  const bool is_joint_assumed =
      column.basis == JointBasis::kAssumed ||
      (is_mapped && column.mappings.front().assumed.find("joint") != std::string::npos);
  add(is_joint_assumed && !column.channel.empty(), "joint");
  const bool is_range = TakesRangeOfFile(inspection, column);
  if (is_mapped) {
    const std::string& given = column.mappings.front().assumed;
    for (const char* word : {"unit", "sign"}) add(given.find(word) != given.npos, word);
    add(is_range || given.find("range") != given.npos, "range");
  } else {
    add(inspection.unit_is_assumed, "unit");
    const bool has_no_sign =
        inspection.unit == RawUnit::kShare || (is_range && column.quantity != Quantity::kMuscle);
    add(inspection.sign_is_assumed || has_no_sign, "sign");
    add(is_range, "range");
  }
  add(inspection.rate_is_assumed, "rate");
  return words;
}

std::string YamlText(const std::string& text) {
  std::string quoted = "\"";
  for (const char letter : text) {
    if (letter == '"' || letter == '\\') quoted.push_back('\\');
    quoted.push_back(letter);
  }
  return quoted + "\"";
}

std::string StarterMap(const Inspection& inspection) {
  std::string map = HeadOfMap(inspection);
  const std::vector<const MoreKey*> keys = MoreKeys(inspection);
  map += "column,channel,unit,sign,raw_low,raw_high,deg_low,deg_high,assumed";
  for (const MoreKey* key : keys) map.append(",").append(key->key);
  map += "\n";
  std::string assumed;
  for (std::size_t c = 0; c < inspection.columns.size(); ++c) {
    const InspectedColumn& column = inspection.columns[c];
    const std::string shown =
        column.name.empty() ? "" : fmt::format(" '{}'", OneLine(column.name, 40));
    const bool is_time = !column.time_unit.empty();
    const bool is_row = IsRow(inspection, column);
    if (inspection.hand && inspection.hand->column == c) {
      map += fmt::format("{},{},,,,,,,{}\n", ColumnText(inspection, c), inspection.hand->side,
                         std::string(keys.size(), ','));
      continue;
    }
    map += fmt::format("# column {}{}: {}{}{}\n", c + 1, shown, is_row ? "" : "left out, ",
                       is_time ? "the time, " + inspection.time_why : column.why,
                       is_row && column.basis == JointBasis::kAssumed ? " (assumed)" : "");
    if (!is_row) continue;
    map += MapRows(inspection, c, keys);
    if (!is_time) assumed += AssumedOf(inspection, column);
  }
  if (!assumed.empty() && inspection.question.empty()) {
    map += fmt::format(
        "# Remove the # of the next line when all that is assumed is right.\n"
        "# all,confirmed,,,,,,,{}\n",
        std::string(keys.size(), ','));
  }
  return map;
}

std::string StarterScenario(const Inspection& inspection, const std::string& recording,
                            const std::string& map) {
  const double glove_hz = GloveRateHz(inspection);
  const std::vector<std::string> channels = MappedChannels(inspection);
  const bool has_index_pip = std::ranges::find(channels, "index_pip") != channels.end();
  constexpr double kMean_s = 0.08;
  const FilterSettings filters = SettingsInCounts(inspection, glove_hz);
  return fmt::format(
      "# Written by gauntlet inspect. The wearer's true motion is unknown: scores compare with "
      "the\n"
      "# recording, smoothed without delay.\n"
      "question: Which filter suits this glove?\n"
      "seed: 1\n"
      "glove:\n"
      "  rate_hz: {:.6g}\n"
      "  channels: [{}]\n"
      "  motion:\n"
      "    kind: recording\n"
      "    file: {}\n"
      "    map: {}\n"
      "{}"
      "  noise: {{kind: none}}  # its own is in the recording\n"
      "video:\n"
      "  channel: {}\n"
      "controllers:\n"
      "  raw: {{filter: none}}\n"
      "  mean: {{filter: {{kind: moving_average, window: {}}}}}\n"
      "  # r is the noise variance of this recording, in {}.\n"
      "  kalman: {{filter: {{kind: kalman, q: {:.3g}, r: {:.3g}}}}}\n"
      "  one_euro: {{filter: {{kind: one_euro, min_cutoff_hz: 1, beta: {:.2g}}}}}\n",
      glove_hz, fmt::join(channels, ", "), YamlText(recording), YamlText(map),
      MotionSettings(inspection, glove_hz), has_index_pip ? "index_pip" : channels.front(),
      std::max(2, static_cast<int>(std::lround(kMean_s * glove_hz))),
      HasOwnCounts(inspection) ? "counts^2 of the glove"
                               : "counts^2 of 10 bits over a joint's range",
      filters.q, filters.r, filters.beta);
}

}  // namespace gauntlet::sim
