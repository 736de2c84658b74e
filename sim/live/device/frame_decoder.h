#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/live/device/address.h"
#include "sim/live/device/frame.h"
#include "sim/live/device/sender_clock.h"

namespace gauntlet::sim {

/// How the bytes of a device follow each other.
enum class ByteFlow {
  kPackets,      // whole frames in each packet
  kWholeStream,  // the first byte begins a frame, as of a pipe
  kCutStream,    // the first byte may be within a frame, as on a serial line
};

/// Makes frames of bytes. It knows no device and reads no clock or file.
class FrameDecoder {
 public:
  virtual ~FrameDecoder() = default;

  /// The next bytes, all of this arrival. Passes on each frame that is whole then. Errors: as of
  /// FrameSource::Wait().
  virtual void Decode(std::string_view bytes, std::int64_t arrival_ns,
                      const FrameReceiver& receive) = 0;
  /// The bytes that were taken are the end of a packet: no frame goes on in the next one.
  virtual void EndPacket(std::int64_t arrival_ns, const FrameReceiver& receive) = 0;
  /// The next bytes may begin within a frame.
  virtual void Restart() = 0;
  /// Bytes to send to the device now, which are asked for before each wait; mostly none.
  virtual std::string Request(std::int64_t /*now_ns*/) { return {}; }
  /// Bytes to send to the device at the end; mostly none.
  virtual std::string Farewell() const { return {}; }

  /// The detected or chosen format; kDetect: not known yet.
  virtual FrameFormat format() const = 0;
  virtual const DeviceColumns& columns() const { return columns_; }
  /// Counts of frames, garbage and half frames alone.
  virtual const SourceCounts& counts() const { return counts_; }
  virtual const std::string& problem() const { return problem_; }

 protected:
  void CountGarbage(std::string problem) {
    ++counts_.garbage;
    problem_ = std::move(problem);
  }
  void CountHalf(std::string problem) {
    ++counts_.half_frames;
    problem_ = std::move(problem);
  }
  /// The names of columns; those of time and number follow from them. Empty: not known.
  void NameColumns(std::vector<std::string> names);
  /// Passes on a frame of these values, with number and time of its columns.
  void Emit(std::span<double> values, std::int64_t arrival_ns, const FrameReceiver& receive);
  /// Passes on a frame of a format with number and time of its own.
  void Emit(DeviceFrame frame, std::span<double> values, const FrameReceiver& receive);

  DeviceColumns columns_;
  SourceCounts counts_;
  std::string problem_;

 private:
  SenderClock clock_;
  std::optional<std::size_t> time_without_unit_;  // a column of columns_
};

/// The decoder of a format. kDetect: the first format that makes a frame of the bytes.
/// `osc_address`: as of DeviceAddress.
std::unique_ptr<FrameDecoder> MakeFrameDecoder(FrameFormat format, ByteFlow flow,
                                               const std::string& osc_address = {});

/// Number and time of a row, from its columns. An infinite value becomes a missing one.
DeviceFrame FrameOf(const DeviceColumns& columns, std::span<double> values,
                    std::int64_t arrival_ns);

}  // namespace gauntlet::sim
