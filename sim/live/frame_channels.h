#pragma once

#include <span>
#include <string>
#include <vector>

#include "controller/controller_config.h"
#include "sim/live/device/frame.h"
#include "sim/recordings/channel_values.h"

namespace gauntlet::sim {

/// Settings for the columns of a glove's frames.
struct FrameChannelsConfig {
  controller::GloveCalibration glove;
  std::string source;  // of the frames, for messages
  std::string map;     // column map, or the name of a preset; empty: names or number of columns
  std::string unit;    // of columns whose names have none: deg, rad, counts or share; empty: deg of
                       // channels, counts of values in their order
  bool drives_motors = false;  // real ones: a map that assumes something is refused
};

/// Columns of frames as counts of a glove's channels, by the same maps as recordings:
///
///     angle_rad = as of ChannelValues
///     counts    = low_counts + (angle_rad - low_angle_rad) (high_counts - low_counts)
///                                                        / (high_angle_rad - low_angle_rad)
///
/// Without a map, columns that are called like channels (`index_mcp_deg`, `_rad`, `_counts`) are
/// these; frames without such names that have as many values as the glove has channels are its
/// counts in their order. Counts without a calibration of their own pass as they are.
class FrameChannels {
 public:
  explicit FrameChannels(FrameChannelsConfig config);

  /// Counts of every channel of a frame with these columns, sent at `time_s` of any origin; NaN: no
  /// value. Valid until the next call.
  /// Errors: UserError for columns that do not give every channel, with what to do.
  std::span<const double> Counts(const DeviceColumns& columns, double time_s,
                                 std::span<const double> values);

  /// Meaning taken for the columns, in one line for a person; empty before the first frame.
  const std::string& remark() const { return remark_; }

 private:
  void Configure(const DeviceColumns& columns);
  void ConfigureInOrder(const DeviceColumns& columns);
  [[noreturn]] void Fail(const std::string& problem) const;

  FrameChannelsConfig config_;
  int version_ = -1;
  ChannelValues channels_;
  std::vector<double> counts_;
  std::string remark_;
};

}  // namespace gauntlet::sim
