#include "sim/recordings/inspect/starter_files.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "sim/base/channels.h"
#include "sim/base/error.h"
#include "sim/base/signal.h"
#include "sim/base/text.h"

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

/// True for counts, volts and unknown units. The lowest and highest values of the recording then
/// stand for the ends of the joint's range, or of the part that a hand uses.
bool NeedsTwoPoints(RawUnit unit) {
  return unit == RawUnit::kCounts || unit == RawUnit::kVolts || unit == RawUnit::kUnknown;
}

/// Lower end of the range that a hand uses. Few people bend a knuckle back by 45 degrees.
double LowDegOf(const Channel& joint) {
  return joint.name.ends_with("_mcp") ? std::max(joint.min_deg, 0.0) : joint.min_deg;
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
    return fmt::format("{},{},,,,", NameOf(inspection.unit), column.is_inverted ? "-1" : "1");
  }
  double low = column.statistics.usual_low;
  double high = column.statistics.usual_high;
  if (!(high > low)) high = low + std::max(1.0, 1e-3 * std::abs(low));
  std::string ends = fmt::format("{:.6g},{:.6g}", low, high);
  if (high - low < 1e-3 * std::max(std::abs(low), std::abs(high))) {
    ends = fmt::format("{},{}", low, high);  // six digits would make them equal
  }
  return fmt::format(
      "{},,{},{}",
      NameOf(inspection.unit == RawUnit::kUnknown ? RawUnit::kCounts : inspection.unit), ends,
      ends_deg);
}

/// Guesses in a column's angle, as words of the map.
std::string AssumedOf(const Inspection& inspection, const InspectedColumn& column) {
  std::string words;
  const auto add = [&words](bool is_assumed, const char* word) {
    if (is_assumed) words += (words.empty() ? "" : " ") + std::string(word);
  };
  add(column.basis == JointBasis::kAssumed && !column.channel.empty(), "joint");
  add(inspection.unit_is_assumed, "unit");
  add(inspection.sign_is_assumed, "sign");
  add(NeedsTwoPoints(inspection.unit), "range");
  add(inspection.rate_is_assumed, "rate");
  return words;
}

/// True if the recorded counts reach the controllers: see OwnCountsOf.
bool HasOwnCounts(const Inspection& inspection) {
  return inspection.unit == RawUnit::kCounts &&
         std::ranges::all_of(inspection.MappedColumns(), [&](std::size_t c) {
           return inspection.columns[c].statistics.usual_low >= 0.0;
         });
}

bool HasTurns(const Inspection& inspection) {
  return std::ranges::any_of(inspection.columns, &InspectedColumn::is_turning);
}

bool HasEnvelopes(const Inspection& inspection) {
  return std::ranges::any_of(
      inspection.columns, [](const InspectedColumn& column) { return column.envelope_ms > 0.0; });
}

/// Keys that only some maps have, with a comma in front of each.
std::string MoreKeys(const Inspection& inspection) {
  constexpr int kMostBits = 24;  // of a map
  if (HasEnvelopes(inspection)) return ",envelope_ms";
  if (inspection.unit == RawUnit::kCounts && inspection.bits <= kMostBits) return ",bits";
  return HasTurns(inspection) ? ",offset,wraps_at" : "";
}

/// A row of the map; a sensor that drives no joint is ignored.
std::string MapRow(const Inspection& inspection, std::size_t c) {
  const InspectedColumn& column = inspection.columns[c];
  const std::string name = ColumnText(inspection, c);
  const std::string keys = MoreKeys(inspection);
  const std::string more(std::ranges::count(keys, ','), ',');
  if (!column.time_unit.empty()) {
    return fmt::format("{},time,{},,,,,,{}\n", name, column.time_unit, more);
  }
  const bool has_joint = !column.channel.empty();
  const Channel* joint = has_joint ? &KnownChannels()[ChannelIndex(column.channel)] : nullptr;
  const std::string values = column.is_turning ? fmt::format(",{:g},360", column.turned_deg)
                             : column.envelope_ms > 0.0 ? fmt::format(",{:g}", column.envelope_ms)
                             : keys == ",bits"          ? fmt::format(",{}", inspection.bits)
                                                        : more;
  return fmt::format("{},{},{},{}{}\n", name, has_joint ? column.channel : "ignore",
                     AngleCells(inspection, column, joint), AssumedOf(inspection, column), values);
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
    double per_unit = kCountsPerRange / (joint.max_deg - joint.min_deg);
    if (inspection.unit == RawUnit::kRadians) per_unit *= kDegPerRad;
    if (NeedsTwoPoints(inspection.unit) || inspection.unit == RawUnit::kShare) {
      const double range = inspection.unit == RawUnit::kShare
                               ? (inspection.unit_high > 1.5 ? 100.0 : 1.0)
                               : column.usual_high - column.usual_low;
      per_unit *= (joint.max_deg - LowDegOf(joint)) / std::max(range, 1e-9);
    }
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
    for (const std::size_t c : inspection.MappedColumns()) {
      if (inspection.columns[c].channel == channel.name) names.emplace_back(channel.name);
    }
  }
  return names;
}

/// Settings of the motion that depend on what was found in the recording.
std::string MotionSettings(const Inspection& inspection, double glove_hz) {
  constexpr double kLongest_s = 60.0;
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
  const std::string keys = MoreKeys(inspection);
  map +=
      fmt::format("column,channel,unit,sign,raw_low,raw_high,deg_low,deg_high,assumed{}\n", keys);
  std::string assumed;
  for (std::size_t c = 0; c < inspection.columns.size(); ++c) {
    const InspectedColumn& column = inspection.columns[c];
    const std::string shown =
        column.name.empty() ? "" : fmt::format(" '{}'", OneLine(column.name, 40));
    const bool is_time = !column.time_unit.empty();
    const bool is_row = is_time || (column.is_sensor && !column.is_dead);
    map += fmt::format("# column {}{}: {}{}{}\n", c + 1, shown, is_row ? "" : "left out, ",
                       is_time ? "the time, " + inspection.time_why : column.why,
                       is_row && column.basis == JointBasis::kAssumed ? " (assumed)" : "");
    if (!is_row) continue;
    map += MapRow(inspection, c);
    if (!is_time) assumed += AssumedOf(inspection, column);
  }
  if (!assumed.empty() && inspection.question.empty()) {
    map += fmt::format(
        "# Remove the # of the next line when all that is assumed is right.\n"
        "# all,confirmed,,,,,,,{}\n",
        std::string(std::ranges::count(keys, ','), ','));
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
