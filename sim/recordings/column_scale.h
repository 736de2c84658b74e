#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "sim/recordings/channel_values.h"
#include "sim/recordings/column_map.h"

namespace gauntlet::sim {

/// Contribution of a mapping to the angle of its channel: factor * value + offset_rad, its weight
/// included.
struct ColumnScale {
  double factor = 1.0;  // rad per unit of the column
  double offset_rad = 0.0;
};

/// Facts about the counts of a channel without a map: the converter's smallest value, and those at
/// the ends of the joint's range. By default 10 and 90 % of 10 bits.
struct NominalCounts {
  double min_counts = 0.0;
  double low_counts = 102.3;
  double high_counts = 920.7;
};

/// `nominal`: of the channel. Where the map gives bits, only its smallest value matters.
ColumnScale ScaleOf(const ColumnMapping& mapping, const NominalCounts& nominal);

/// All that a row of a map does to the values of its column, for ChannelValues: angles [rad].
ChannelValues::Part PartOf(const ColumnMapping& mapping, const NominalCounts& nominal);

/// The counts of a glove's own converter in one column: the channel's calibration.
struct OwnCounts {
  int channel = 0;
  ColumnScale scale;        // counts to angle
  double low_counts = 0.0;  // the two points of the map, else the ends of the joint's range
  double high_counts = 0.0;
  int bits = 0;         // of the converter; 0: not in the map
  std::string assumed;  // as in the map; empty if a person confirmed it
};

/// The channels that a map takes from one column of counts each, without weights of other columns
/// and jumps. `nominal`: one for all channels, or one for each of KnownChannels().
std::vector<OwnCounts> OwnCountsOf(const ColumnMap& map, std::span<const NominalCounts> nominal);

}  // namespace gauntlet::sim
