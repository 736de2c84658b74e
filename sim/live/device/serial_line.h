#pragma once

#include <cstdint>
#include <string>

#include "sim/base/descriptor.h"
#include "sim/live/device/address.h"

namespace gauntlet::sim {

/// An open serial line: 8 data bits, no parity, 1 stop bit, no flow control. Reads and writes never
/// wait.
class SerialLine {
 public:
  /// Errors: UserError in one line that says what to try.
  explicit SerialLine(const DeviceAddress& address);

  bool is_open() const { return line_.is_open(); }
  int descriptor() const { return line_.get(); }
  void Close() { line_.Close(); }
  /// Opens a line again that was closed, at most five times per second. Returns the reason if it
  /// stays closed; empty if it is open.
  std::string Reopen();
  /// Settings that the system allowed, as `low latency, latency timer 1 ms`.
  const std::string& facts() const { return facts_; }

 private:
  void Open();

  DeviceAddress address_;
  Descriptor line_;
  std::string facts_;
  std::string why_closed_;
  std::int64_t last_try_ns_ = 0;
};

}  // namespace gauntlet::sim
