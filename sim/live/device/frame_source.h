#pragma once

#include <chrono>
#include <memory>
#include <string>

#include "sim/live/device/address.h"
#include "sim/live/device/frame.h"

namespace gauntlet::sim {

/// Settings of a source that are no part of its address.
struct SourceOptions {
  double file_rate_hz = 0.0;        // rows per second of a file; 0: by its time column
  bool is_paced = true;             // rows of a file come at their times; false: at once
  std::string file_array = {};      // of a file with arrays or topics: see TableSource()
  std::string file_time_unit = {};  // of its column of time, if that is of numbers; empty: found
};

/// Frames of a device. One thread owns a source and calls all its functions.
///
/// A device that vanishes is opened again while Wait() waits. Bytes that are no whole frame are
/// counted and left out; no frame is ever made of parts of two.
class FrameSource {
 public:
  enum class State {
    kOpen,
    kGone,   // the device vanished; Wait() tries to open it again
    kEnded,  // file or standard input: no frame will follow
  };

  virtual ~FrameSource() = default;

  /// Waits for bytes, at most this long (less after a signal), and passes on every whole frame
  /// that has arrived, in the order of arrival. Errors: UserError for frames that need a choice of
  /// the user, such as OSC messages of several addresses; what `receive` throws.
  virtual State Wait(std::chrono::nanoseconds timeout, const FrameReceiver& receive) = 0;

  /// Names may become known, or change, with a frame: see DeviceColumns::version.
  virtual const DeviceColumns& columns() const = 0;
  virtual SourceCounts counts() const = 0;
  /// The latest reason for which bytes were left out, or for which a device is gone; empty: none.
  virtual std::string problem() const = 0;
  /// Address, format and what the system allowed, in one line, as
  /// `serial:/dev/ttyUSB0@115200, csv, low latency`.
  virtual std::string Description() const = 0;

  /// One line for a source without frames: what arrived, and what to try.
  std::string AdviceWithoutFrames() const;

  virtual const DeviceAddress& address() const = 0;

 private:
  /// The first bytes that arrived.
  virtual std::string Beginning() const { return {}; }
};

/// Opens the device. Errors: UserError in one line that says what to try: no such device, a baud
/// rate that does not exist, no permission (with the group to join), a device or port in use.
std::unique_ptr<FrameSource> OpenFrameSource(const DeviceAddress& address,
                                             const SourceOptions& options = {});

}  // namespace gauntlet::sim
