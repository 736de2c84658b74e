#include "sim/recordings/column_scale.h"

#include <algorithm>
#include <cmath>

#include "sim/base/channels.h"
#include "sim/base/signal.h"

namespace gauntlet::sim {
namespace {

// Where the nominal sensor has the lower end of a joint's range, of a converter's full scale.
constexpr double kNominalLowShare = 0.1;

}  // namespace

ColumnScale ScaleOf(const ColumnMapping& mapping, const NominalCounts& nominal) {
  const Channel& joint = KnownChannels()[mapping.channel];
  const double min_rad = joint.min_deg * kRadPerDeg;
  const double range_rad = (joint.max_deg - joint.min_deg) * kRadPerDeg;
  double factor = kRadPerDeg;  // rad per unit
  double zero_rad = 0.0;       // angle at 0
  if (mapping.unit == RecordedUnit::kRadians) {
    factor = 1.0;
  } else if (mapping.unit == RecordedUnit::kShare) {
    factor = range_rad;
    zero_rad = min_rad;
  } else if (mapping.unit == RecordedUnit::kCounts) {
    double low_counts = nominal.low_counts;
    double high_counts = nominal.high_counts;
    if (mapping.bits > 0) {
      const double full_scale_counts = std::ldexp(1.0, mapping.bits) - 1.0;
      low_counts = nominal.min_counts + kNominalLowShare * full_scale_counts;
      high_counts = nominal.min_counts + (1.0 - kNominalLowShare) * full_scale_counts;
    }
    factor = range_rad / (high_counts - low_counts);
    zero_rad = min_rad - low_counts * factor;
  }
  return {.factor = mapping.weight * factor * mapping.scale,
          .offset_rad = mapping.weight * (zero_rad + factor * mapping.offset)};
}

ChannelValues::Part PartOf(const ColumnMapping& mapping, const NominalCounts& nominal) {
  const ColumnScale scale = ScaleOf(mapping, nominal);
  return {.column = mapping.column,
          .factor = scale.factor,
          .offset = scale.offset_rad,
          .wraps_at = mapping.wraps_at,
          .envelope_ms = mapping.envelope_ms};
}

std::vector<OwnCounts> OwnCountsOf(const ColumnMap& map, std::span<const NominalCounts> nominal) {
  const double most_counts = std::ldexp(1.0, kMostMapBits) - 1.0;
  std::vector<OwnCounts> all;
  for (const ColumnMapping& mapping : map.channels) {
    const NominalCounts& of_channel = nominal[PlaceInList(mapping.channel, nominal.size())];
    const ColumnScale scale = ScaleOf(mapping, of_channel);
    const bool is_only =
        std::ranges::count(map.channels, mapping.channel, &ColumnMapping::channel) == 1;
    if (!mapping.in_counts || !is_only || mapping.wraps_at > 0.0 || scale.factor == 0.0) continue;
    const Channel& joint = KnownChannels()[mapping.channel];
    const auto counts_at = [&scale](double deg) {
      return (deg * kRadPerDeg - scale.offset_rad) / scale.factor;
    };
    const RawPoints points = mapping.points.value_or(
        RawPoints{.low = counts_at(joint.min_deg), .high = counts_at(joint.max_deg)});
    const auto [least, most] = std::minmax(points.low, points.high);
    const double beyond = most - of_channel.min_counts;
    if (least < of_channel.min_counts || beyond > most_counts)
      continue;  // no converter gives these
    std::string assumed = mapping.points || !mapping.assumed.empty() ? mapping.assumed : "range";
    if (map.is_confirmed) assumed.clear();
    all.push_back({.channel = mapping.channel,
                   .scale = scale,
                   .low_counts = points.low,
                   .high_counts = points.high,
                   .bits = mapping.bits,
                   .assumed = assumed});
  }
  return all;
}

}  // namespace gauntlet::sim
