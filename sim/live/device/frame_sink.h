#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "sim/live/device/address.h"

namespace gauntlet::sim {

/// A frame to be sent: motor counts, or the counts of a simulated glove.
struct OutgoingFrame {
  std::int64_t number = 0;
  std::int64_t time_ns = 0;             // CLOCK_MONOTONIC
  std::span<const double> values = {};  // kMissing: no value
};

/// Counts of a sink since it was opened.
struct SinkCounts {
  std::uint64_t frames = 0;   // that the system took
  std::uint64_t dropped = 0;  // whole frames for which there was no room; a newer one replaced them
  std::uint64_t failed = 0;   // the other end was gone
  std::uint64_t bytes = 0;
};

/// Sends frames to a device. One thread owns a sink.
class FrameSink {
 public:
  enum class Result {
    kSent,
    kDropped,  // no room at the moment
    kGone,     // the other end is gone: no listener, closed pipe, vanished device. The next Send()
               // tries again, unless it is a pipe
  };

  virtual ~FrameSink() = default;

  /// Sends one frame and never waits for the other end. `values` has one per name.
  virtual Result Send(const OutgoingFrame& frame) = 0;
  virtual SinkCounts counts() const = 0;
  /// The system's reason for the last kGone; empty: none.
  virtual std::string problem() const = 0;
  virtual std::string Description() const = 0;
};

/// Opens the sink. `names` are those of the values: they are sent first, and over UDP once a
/// second, so that a listener that starts later knows them, too. `repeats_names`: so over a serial
/// line, to a listener that takes them between frames.
/// Errors: UserError in one line that says what to try, as of OpenFrameSource().
std::unique_ptr<FrameSink> OpenFrameSink(const DeviceAddress& address,
                                         const std::vector<std::string>& names,
                                         bool repeats_names = false);

}  // namespace gauntlet::sim
