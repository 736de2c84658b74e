#include "sim/inspect/starter_files.h"

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

std::string MapRow(const Inspection& inspection, std::size_t c) {
  const InspectedColumn& column = inspection.columns[c];
  const std::string name = ColumnText(inspection, c);
  if (!column.time_unit.empty()) return fmt::format("{},time,{},,,,,\n", name, column.time_unit);
  const Channel& joint = KnownChannels()[ChannelIndex(column.channel)];
  if (!NeedsTwoPoints(inspection.unit)) {
    const bool is_share = inspection.unit == RawUnit::kShare;
    // The whole range would let 0 mean a knuckle that is bent back, not a straight finger.
    if (is_share) {
      return fmt::format("{},{},deg,,0,1,{:g},{:g}\n", name, joint.name, LowDegOf(joint),
                         joint.max_deg);
    }
    return fmt::format("{},{},{},{},,,,\n", name, joint.name, NameOf(inspection.unit),
                       column.is_inverted ? "-1" : "1");
  }
  double low = column.statistics.usual_low;
  double high = column.statistics.usual_high;
  if (!(high > low)) high = low + std::max(1.0, 1e-3 * std::abs(low));
  std::string ends = fmt::format("{:.6g},{:.6g}", low, high);
  if (high - low < 1e-3 * std::max(std::abs(low), std::abs(high))) {
    ends = fmt::format("{},{}", low, high);  // six digits would make them equal
  }
  return fmt::format(
      "{},{},{},,{},{:g},{:g}\n", name, joint.name,
      NameOf(inspection.unit == RawUnit::kUnknown ? RawUnit::kCounts : inspection.unit), ends,
      LowDegOf(joint), joint.max_deg);
}

/// Noise variance of the glove in counts^2 of the scenario's converter (10 bits over the joint's
/// range): the median over the channels, at least the quantisation noise.
double VarianceCounts2(const Inspection& inspection) {
  constexpr double kCountsPerRange = 0.8 * 1023.0;
  std::vector<double> variances;
  for (const std::size_t c : inspection.MappedColumns()) {
    const ColumnStatistics& column = inspection.columns[c].statistics;
    const Channel& joint = KnownChannels()[ChannelIndex(inspection.columns[c].channel)];
    double per_unit = kCountsPerRange / (joint.max_deg - joint.min_deg);
    if (inspection.unit == RawUnit::kRadians) per_unit *= kDegPerRad;
    if (NeedsTwoPoints(inspection.unit) || inspection.unit == RawUnit::kShare) {
      const double range =
          inspection.unit == RawUnit::kShare ? 1.0 : column.usual_high - column.usual_low;
      per_unit *= (joint.max_deg - LowDegOf(joint)) / std::max(range, 1e-9);
    }
    const double noise = std::max(column.noise, column.step / std::sqrt(12.0)) * per_unit;
    variances.push_back(noise * noise);
  }
  std::ranges::sort(variances);
  return std::clamp(variances[variances.size() / 2], 0.1, 1e4);
}

/// True if a mapped angle exceeds its joint's range by more than half of it. Such rows are glitches
/// or belong to another joint.
bool LeavesItsJoint(const Inspection& inspection) {
  const bool is_angle =
      inspection.unit == RawUnit::kDegrees || inspection.unit == RawUnit::kRadians;
  const double deg = inspection.unit == RawUnit::kRadians ? kDegPerRad : 1.0;
  return is_angle && std::ranges::any_of(inspection.MappedColumns(), [&](std::size_t c) {
           const InspectedColumn& column = inspection.columns[c];
           const Channel& joint = KnownChannels()[ChannelIndex(column.channel)];
           const double sign = column.is_inverted ? -deg : deg;
           const auto [low, high] =
               std::minmax({sign * column.statistics.low, sign * column.statistics.high});
           return std::max(joint.min_deg - low, high - joint.max_deg) >
                  0.5 * (joint.max_deg - joint.min_deg);
         });
}

/// Text in double quotes for YAML.
std::string YamlText(const std::string& text) {
  std::string quoted = "\"";
  for (const char letter : text) {
    if (letter == '"' || letter == '\\') quoted.push_back('\\');
    quoted.push_back(letter);
  }
  return quoted + "\"";
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
  constexpr double kLongest_s = 30.0;
  constexpr double kSmoothingHz = 5.0;
  constexpr double kShortestGap_ms = 100.0;
  constexpr double kLongestGap_ms = 1e7;  // upper limit of the setting
  const TimeStatistics& time = inspection.time;
  std::string text;
  const auto add = [&text](std::string_view key, const std::string& value,
                           std::string_view remark = "") {
    text += fmt::format("    {}: {}{}{}\n", key, value, remark.empty() ? "" : "  # ", remark);
  };
  if (!inspection.array.empty()) add("array", YamlText(inspection.array));
  if (const int lines = inspection.layout.skipped_lines; lines > 0) {
    add("skip_lines", std::to_string(lines));
  }
  if (!inspection.has_time) {
    add("file_rate_hz", fmt::format("{:.6g}", time.rate_hz),
        inspection.rate_is_known ? "" : "an assumption: the file has no time");
  }
  add("use", "measured");
  add("problems", "repair");
  // A gap must exceed the file's own jitter.
  const double gap_ms =
      std::clamp(std::max(3e3 / time.rate_hz, 2.0 * time.long_ms), kShortestGap_ms, kLongestGap_ms);
  if (gap_ms > kShortestGap_ms) add("longest_gap_ms", fmt::format("{:.4g}", gap_ms));
  const double odd_rows = static_cast<double>(time.repeats + time.restarts + time.gaps);
  if (odd_rows > 0.04 * static_cast<double>(inspection.rows)) {
    add("repair_budget_percent", "100", "many times repeat, or are out of order");
  } else if (LeavesItsJoint(inspection)) {
    add("repair_budget_percent", "100", "angles far beyond their joints' ranges: see the map");
  }
  if (time.duration_s > kLongest_s) {
    add("duration_s", fmt::format("{:g}", kLongest_s), fmt::format("of {:.5g}", time.duration_s));
  }
  if (glove_hz < 5.0 * kSmoothingHz) add("smoothing_hz", fmt::format("{:.3g}", 0.2 * glove_hz));
  return text;
}

}  // namespace

std::string StarterMap(const Inspection& inspection) {
  if (inspection.MappedColumns().empty()) {
    throw UserError({.place = inspection.file,
                     .problem = "no column looks like a sensor of a hand; a column map can name "
                                "them (sim/recordings/README.md)"});
  }
  std::string map =
      "# Which column is which joint, as far as gauntlet inspect could tell: check it, above all "
      "what is\n# called an assumption. sim/recordings/README.md has the language.\n";
  map += fmt::format("# unit: {} ({})\n", NameOf(inspection.unit), inspection.unit_why);
  if (NeedsTwoPoints(inspection.unit)) {
    map +=
        "# raw_low and raw_high are the least and most that came (half a percent apart), "
        "taken for a straight and\n# a bent joint (assumption): put in what your glove gives at "
        "known angles, the other way round if it falls.\n";
  }
  map += "column,channel,unit,sign,raw_low,raw_high,deg_low,deg_high\n";
  for (std::size_t c = 0; c < inspection.columns.size(); ++c) {
    const InspectedColumn& column = inspection.columns[c];
    const std::string shown =
        column.name.empty() ? "" : fmt::format(" '{}'", OneLine(column.name, 40));
    if (column.channel.empty() && column.time_unit.empty()) {
      map += fmt::format("# column {}{}: left out, {}\n", c + 1, shown, column.why);
      continue;
    }
    map += fmt::format("# column {}{}: {}\n", c + 1, shown,
                       column.time_unit.empty() ? column.why : "the time, " + inspection.time_why);
    map += MapRow(inspection, c);
  }
  return map;
}

std::string StarterScenario(const Inspection& inspection, const std::string& recording,
                            const std::string& map) {
  const double glove_hz = GloveRateHz(inspection);
  const std::vector<std::string> channels = MappedChannels(inspection);
  const bool has_index_pip = std::ranges::find(channels, "index_pip") != channels.end();
  constexpr double kMean_s = 0.08;
  return fmt::format(
      "# Made by gauntlet inspect. Nobody knows the wearer's true motion: scores compare with the "
      "recording\n# smoothed without delay, and say so.\n"
      "question: Which filter calms this glove?\n"
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
      "  # r is the noise of this recording, in counts of 10 bits over a joint's range.\n"
      "  kalman: {{filter: {{kind: kalman, q: {:.3g}, r: {:.3g}}}}}\n"
      "  one_euro: {{filter: {{kind: one_euro, min_cutoff_hz: 1, beta: 0.03}}}}\n",
      glove_hz, fmt::join(channels, ", "), YamlText(recording), YamlText(map),
      MotionSettings(inspection, glove_hz), has_index_pip ? "index_pip" : channels.front(),
      std::max(2, static_cast<int>(std::lround(kMean_s * glove_hz))), 10.0 / glove_hz,
      VarianceCounts2(inspection));
}

}  // namespace gauntlet::sim
