#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "sim/live/device/address.h"
#include "sim/live/device/frame_decoder.h"
#include "sim/live/device/frame_source.h"

namespace gauntlet::sim {

/// Bytes that arrived together.
struct ArrivedBytes {
  std::string_view bytes;
  std::int64_t arrival_ns = 0;  // CLOCK_MONOTONIC
};

/// Bytes of a device as they come. It knows no formats.
class ByteDevice {
 public:
  using Receiver = std::function<void(const ArrivedBytes& arrived)>;

  virtual ~ByteDevice() = default;

  /// Waits for bytes, at most this long, and passes on all that have arrived.
  virtual FrameSource::State Wait(std::chrono::nanoseconds timeout, const Receiver& receive) = 0;
  /// Sends bytes back, if the device takes them now.
  virtual void Write(std::string_view /*bytes*/) {}
  virtual ByteFlow flow() const = 0;
  /// Counts of packets and openings alone.
  const SourceCounts& counts() const { return counts_; }
  const std::string& problem() const { return problem_; }
  /// Settings that the system allowed; may be empty.
  virtual std::string Facts() const { return {}; }

 protected:
  SourceCounts counts_;
  std::string problem_;
};

/// Errors: as of OpenFrameSource().
std::unique_ptr<ByteDevice> OpenStandardInput();
std::unique_ptr<ByteDevice> OpenUdpListener(const DeviceAddress& address);
std::unique_ptr<ByteDevice> OpenSerialPort(const DeviceAddress& address);

/// Waits until a descriptor is readable. False after the timeout or a signal.
bool WaitReadable(int descriptor, std::chrono::nanoseconds timeout);

}  // namespace gauntlet::sim
