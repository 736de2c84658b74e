#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "sim/device/address.h"
#include "sim/device/frame.h"

namespace gauntlet::sim {

/// Makes frames of bytes. It knows no device, no clock and no file.
class FrameDecoder {
 public:
  virtual ~FrameDecoder() = default;

  /// The next bytes, all of this arrival. Passes on each frame that is whole then.
  virtual void Take(std::string_view bytes, std::int64_t arrival_ns,
                    const FrameReceiver& receive) = 0;
  /// The bytes that were taken are the end of a packet: a frame never goes on in the next one.
  virtual void EndPacket(std::int64_t arrival_ns, const FrameReceiver& receive) = 0;
  /// The next bytes may begin within a frame.
  virtual void Restart() = 0;
  /// Bytes to send to the device now, which are asked for before each wait; mostly none.
  virtual std::string Request(std::int64_t /*now_ns*/) { return {}; }

  /// The detected or chosen format; kDetect: not known yet.
  virtual FrameFormat format() const = 0;
  const DeviceColumns& columns() const { return columns_; }
  /// Of frames, garbage and half frames alone.
  const SourceCounts& counts() const { return counts_; }
  const std::string& problem() const { return problem_; }

 protected:
  void CountGarbage(std::string problem) {
    ++counts_.garbage;
    problem_ = std::move(problem);
  }
  void CountHalf(std::string problem) {
    ++counts_.half_frames;
    problem_ = std::move(problem);
  }

  DeviceColumns columns_;
  SourceCounts counts_;
  std::string problem_;
};

/// The decoder of a format, or one that detects it: the first format that makes a frame of the
/// bytes. `begins_whole`: the first bytes are the beginning of a frame, as in a packet; false on a
/// serial line. `osc_address`: as of DeviceAddress.
std::unique_ptr<FrameDecoder> MakeFrameDecoder(FrameFormat format, bool begins_whole,
                                               const std::string& osc_address = {});

/// Sets names of `columns` and, from them, the columns of time and number.
void SetColumnNames(std::vector<std::string> names, DeviceColumns& columns);
/// A frame of these values: number and time are taken from the columns, and an infinite value is a
/// missing one.
DeviceFrame FrameOf(const DeviceColumns& columns, std::span<double> values,
                    std::int64_t arrival_ns);

}  // namespace gauntlet::sim
