#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/recordings/column_map.h"

namespace gauntlet::sim {

/// A whole frame that arrived from a device. `values` is valid during the call that passes it.
struct DeviceFrame {
  std::int64_t arrival_ns = 0;                      // CLOCK_MONOTONIC
  std::optional<std::int64_t> number = {};          // counted by the sender
  std::optional<std::int64_t> sender_time_ns = {};  // by the sender's own clock, of any origin
  std::span<const double> values = {};              // one per column; kMissing: no value
};

using FrameReceiver = std::function<void(const DeviceFrame& frame)>;

/// The columns of a device's frames, as a column map needs them (see RecordingColumns). Time and
/// number stay columns, so that their places are those of a file with the same rows.
struct DeviceColumns {
  std::vector<std::string> names;          // empty: not known, or not yet
  std::size_t count = 0;                   // 0: before the first frame
  std::optional<std::size_t> number = {};  // column of DeviceFrame::number
  std::vector<TimeMapping> time = {};      // columns of DeviceFrame::sender_time_ns
  int version = 0;                         // grows with every change
};

/// Counts of a source since it was opened.
struct SourceCounts {
  std::uint64_t frames = 0;
  std::uint64_t garbage = 0;      // lines, packets and stretches of bytes that are no frame
  std::uint64_t half_frames = 0;  // that begin or end too early
  std::uint64_t foreign = 0;      // packets of another sender than the one in use
  std::uint64_t overflowed = 0;   // packets that the system dropped: they were not taken in time
  std::uint64_t reopened = 0;     // times that a device came back
  std::uint64_t bytes = 0;
};

}  // namespace gauntlet::sim
