#include "sim/recordings/inspect/health.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "sim/base/channels.h"
#include "sim/base/quantile.h"
#include "sim/base/signal.h"
#include "sim/base/text.h"
#include "sim/recordings/column_scale.h"
#include "sim/tables/missing.h"

namespace gauntlet::sim {
namespace {

constexpr double kLeastRangeOverNoise = 10.0;

/// Facts of an inspection that rules compare a sensor with.
struct Others {
  double range_over_noise = 0.0;  // median of the sensors that move
};

struct HealthRule {
  std::string_view key;
  /// The value of a finding, if there is one.
  std::optional<double> (*find)(const Inspection& inspection, std::size_t column);
  std::string (*say)(const Inspection& inspection, std::size_t column, double value,
                     const Others& others);
  bool from_row_to_row = false;  // compares neighbours, which are of one sender then
};

const ColumnStatistics& StatisticsOf(const Inspection& inspection, std::size_t column) {
  return inspection.columns[column].statistics;
}

std::optional<double> IfAbove(double value, double limit) {
  return value > limit ? std::optional(value) : std::nullopt;
}

std::string Percent(double share) { return fmt::format("{:.2g} %", 100.0 * share); }

/// Change of the lowest usual value from the first third to the last, as a share of the range. 0 if
/// a third has less than five movements through the middle of the range: then it is no rest.
double DriftOf(const Inspection& inspection, std::size_t column) {
  constexpr double kRest = 0.05;  // quantile
  constexpr int kFewestMovements = 5;
  std::vector<double> values = inspection.picture_values[column];
  std::erase_if(values, [](double value) { return !std::isfinite(value); });
  const ColumnStatistics& is = StatisticsOf(inspection, column);
  const std::ptrdiff_t third = std::ssize(values) / 3;
  const double low = is.usual_low + 0.4 * (is.usual_high - is.usual_low);
  const double high = is.usual_low + 0.6 * (is.usual_high - is.usual_low);
  std::vector<double> rests;
  for (int part = 0; part < 3; ++part) {
    const std::vector<double> of(values.begin() + part * third,
                                 values.begin() + (part + 1) * third);
    int movements = 0;
    bool is_high = false;
    for (const double value : of) {
      if (!is_high && value > high) ++movements;
      is_high = is_high ? value > low : value > high;
    }
    if (movements < kFewestMovements) return 0.0;
    rests.push_back(Quantile(of, kRest));
  }
  return std::abs(rests.back() - rests.front()) / (is.usual_high - is.usual_low);
}

/// The first sensor that moves and has the same value in every row of the picture.
std::optional<std::size_t> CopyOf(const Inspection& inspection, std::size_t column) {
  constexpr std::size_t kFewestRows = 100;
  const std::vector<double>& own = inspection.picture_values[column];
  if (own.size() < kFewestRows || inspection.columns[column].is_dead) return std::nullopt;
  for (const std::size_t other : inspection.Sensors()) {
    if (other >= column || inspection.columns[other].is_dead) continue;
    if (AreSame(own, inspection.picture_values[other])) return other;
  }
  return std::nullopt;
}

constexpr HealthRule kHealthRules[] = {
    {"dead",
     [](const Inspection& inspection, std::size_t c) -> std::optional<double> {
       const ColumnStatistics& is = StatisticsOf(inspection, c);
       const bool is_dead = inspection.columns[c].is_dead && !IsOnlyNoise(inspection.columns[c]);
       return is_dead ? std::optional(is.commonest_share) : std::nullopt;
     },
     [](const Inspection& inspection, std::size_t c, double value, const Others&) {
       return fmt::format("dead: {:g} in {:.3g} % of the rows; check its cable",
                          StatisticsOf(inspection, c).low, 100.0 * value);
     }},
    {"no_movement",
     [](const Inspection& inspection, std::size_t c) -> std::optional<double> {
       const ColumnStatistics& is = StatisticsOf(inspection, c);
       return IsOnlyNoise(inspection.columns[c]) ? std::optional(RangeOverNoise(is)) : std::nullopt;
     },
     [](const Inspection& inspection, std::size_t, double value, const Others& others) {
       constexpr double kSlow_hz = 8.0;
       if (inspection.time.rate_hz < kSlow_hz) {
         return fmt::format("rows at {:.3g} Hz are too slow to tell movement from noise",
                            inspection.time.rate_hz);
       }
       const std::string others_have = others.range_over_noise > 0.0
                                           ? fmt::format(", others {:.0f}", others.range_over_noise)
                                           : std::string();
       return inspection.is_tracked
                  ? fmt::format(
                        "moves too little for its noise: range/noise {:.0f}{}; show the "
                        "tracker more of it",
                        value, others_have)
                  : fmt::format("does not move: range/noise {:.0f}{}; check its cable", value,
                                others_have);
     },
     true},
    {"lost",
     [](const Inspection& inspection, std::size_t c) {
       constexpr double kWorthALine = 0.01;
       const auto rows = static_cast<double>(inspection.rows);
       return IfAbove(1.0 - static_cast<double>(StatisticsOf(inspection, c).good_rows) / rows,
                      kWorthALine);
     },
     [](const Inspection&, std::size_t, double value, const Others&) {
       return fmt::format("missing in {} of the rows; check its plug and its sender",
                          Percent(value));
     }},
    {"missing_code",
     [](const Inspection& inspection, std::size_t c) {
       return IfAbove(StatisticsOf(inspection, c).code_share, 0.0);
     },
     [](const Inspection& inspection, std::size_t c, double value, const Others&) {
       return fmt::format("{:.10g} in {} of the rows stands for a missing value",
                          StatisticsOf(inspection, c).code, Percent(value));
     }},
    {"copy",
     [](const Inspection& inspection, std::size_t c) -> std::optional<double> {
       const std::optional<std::size_t> other = CopyOf(inspection, c);
       return other ? std::optional(static_cast<double>(*other + 1)) : std::nullopt;
     },
     [](const Inspection& inspection, std::size_t, double value, const Others&) {
       const auto column = static_cast<std::size_t>(value) - 1;
       return fmt::format("equals column {} '{}' in every row; check its cable and the export",
                          column + 1, OneLine(inspection.columns[column].name, 20));
     }},
    {"spikes",
     [](const Inspection& inspection, std::size_t c) {
       constexpr double kWorthALine = 5e-4;
       return IfAbove(StatisticsOf(inspection, c).spike_share, kWorthALine);
     },
     [](const Inspection&, std::size_t, double value, const Others&) {
       return fmt::format("spikes in {} of the rows; check its plug, or use a median filter",
                          Percent(value));
     },
     true},
    {"clipped",
     [](const Inspection& inspection, std::size_t c) {
       constexpr double kOften = 0.1;
       return IfAbove(StatisticsOf(inspection, c).clipped_share, kOften);
     },
     [](const Inspection&, std::size_t, double value, const Others&) {
       return fmt::format("at an end of its range in {} of the rows; widen its range",
                          Percent(value));
     }},
    {"repeats",
     [](const Inspection& inspection, std::size_t c) {
       constexpr double kMost = 0.6;
       const ColumnStatistics& is = StatisticsOf(inspection, c);
       // A sensor at rest with a coarse converter repeats its values as well.
       const bool is_moving = is.noise > 0.0 || is.change > 0.0;
       return IfAbove(is_moving ? 0.0 : is.still_share - is.clipped_share, kMost);
     },
     [](const Inspection& inspection, std::size_t, double value, const Others&) {
       return fmt::format("{} of the rows repeat the one before; its own rate is about {:.3g} Hz",
                          Percent(value), inspection.time.rate_hz * (1.0 - value));
     },
     true},
    {"drift",
     [](const Inspection& inspection, std::size_t c) {
       constexpr double kFar = 0.2;
       return IfAbove(DriftOf(inspection, c), kFar);
     },
     [](const Inspection&, std::size_t, double value, const Others&) {
       return fmt::format(
           "its rest drifts by {} of its range; calibrate it again, or let it warm up",
           Percent(value));
     }},
};

}  // namespace

double RangeOverNoise(const ColumnStatistics& is) {
  const double range = is.usual_high - is.usual_low;
  return is.noise > 0.0 ? range / is.noise : std::numeric_limits<double>::infinity();
}

bool IsOnlyNoise(const InspectedColumn& column) {
  const ColumnStatistics& is = column.statistics;
  constexpr std::size_t kFewestRows = 100;
  // Second differences of white noise are sqrt(3) times as far from zero as its steps, those of a
  // movement that is sampled four times a period or more less than sqrt(2) times.
  const bool is_white = std::sqrt(6.0) * is.noise > std::sqrt(2.0) * is.change;
  // A joint that a tracker sees in as much noise moves in neighbouring rows alike.
  constexpr double kMoves = 1.25;
  return column.quantity != Quantity::kMuscle && is.good_rows >= kFewestRows && is_white &&
         RangeOverNoise(is) < kLeastRangeOverNoise && is.slow < kMoves * is.noise;
}

bool NeedsTwoPoints(RawUnit unit) {
  return unit == RawUnit::kCounts || unit == RawUnit::kVolts || unit == RawUnit::kUnknown;
}

bool TakesRangeOfFile(const ColumnMapping& mapping) {
  return mapping.unit == RecordedUnit::kCounts && !mapping.points;
}

bool TakesRangeOfFile(const Inspection& inspection, const InspectedColumn& column) {
  return column.mappings.empty() ? NeedsTwoPoints(inspection.unit)
                                 : TakesRangeOfFile(column.mappings.front());
}

double DegPerUnitOf(const Inspection& inspection, const InspectedColumn& column) {
  if (column.channel.empty()) return 0.0;
  const Channel& joint = KnownChannels()[ChannelIndex(column.channel)];
  const ColumnStatistics& is = column.statistics;
  if (TakesRangeOfFile(inspection, column)) {
    return (joint.max_deg - LowDegOf(joint)) / std::max(is.usual_high - is.usual_low, 1e-9);
  }
  if (!column.mappings.empty()) {
    return std::abs(ScaleOf(column.mappings.front(), {}).factor) * kDegPerRad;
  }
  if (inspection.HasAngles()) return inspection.DegPerUnit();
  return (joint.max_deg - LowDegOf(joint)) / (inspection.unit_high > 1.5 ? 100.0 : 1.0);
}

std::vector<HealthFinding> HealthOf(const Inspection& inspection) {
  std::vector<double> ratios;
  for (const std::size_t c : inspection.Sensors()) {
    const ColumnStatistics& is = StatisticsOf(inspection, c);
    const double ratio = RangeOverNoise(is);
    if (!IsOnlyNoise(inspection.columns[c]) && std::isfinite(ratio) &&
        !inspection.columns[c].is_dead) {
      ratios.push_back(ratio);
    }
  }
  Others others;
  if (!ratios.empty()) others.range_over_noise = Quantile(ratios, 0.5);
  std::vector<HealthFinding> findings;
  if (const std::optional<Senders>& senders = inspection.senders) {
    findings.push_back({.column = senders->column,
                        .key = "two_senders",
                        .value = 1.0 / senders->every,
                        .sentence = TextOf(*senders)});
  }
  for (const HealthRule& rule : kHealthRules) {
    if (inspection.senders && rule.from_row_to_row) continue;
    const std::size_t first = findings.size();
    for (const std::size_t c : inspection.Sensors()) {
      const bool is_told = std::ranges::any_of(findings, [c](const HealthFinding& finding) {
        return finding.column == c && (finding.key == "dead" || finding.key == "no_movement");
      });
      const std::optional<double> value = rule.find(inspection, c);
      if (is_told || !value) continue;
      findings.push_back({.column = c,
                          .key = std::string(rule.key),
                          .value = *value,
                          .sentence = rule.say(inspection, c, *value, others)});
    }
    std::sort(findings.begin() + static_cast<std::ptrdiff_t>(first), findings.end(),
              [](const HealthFinding& one, const HealthFinding& other) {
                return one.value > other.value;
              });
  }
  return findings;
}

}  // namespace gauntlet::sim
