#pragma once

#include <memory>
#include <string>
#include <vector>

#include "sim/live/device/address.h"
#include "sim/live/device/frame_sink.h"

namespace gauntlet::sim {

/// Makes bytes of frames: the inverse of FrameDecoder.
class FrameEncoder {
 public:
  virtual ~FrameEncoder() = default;

  /// Bytes that name the values; empty in a format without names.
  virtual std::string Names() const { return {}; }
  virtual std::string Frame(const OutgoingFrame& frame) const = 0;
};

/// Errors: UserError for a format that cannot be written, or not with these names.
std::unique_ptr<FrameEncoder> MakeFrameEncoder(const DeviceAddress& address,
                                               const std::vector<std::string>& names);

}  // namespace gauntlet::sim
