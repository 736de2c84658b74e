#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sim/live/device/frame_decoder.h"
#include "sim/live/device/frame_sink.h"

namespace gauntlet::sim {

/// Frames of Gauntlet's own binary format, little-endian:
///
///     offset  size  content
///     0       4     f7 47 4e 54: a byte that no text in UTF-8 has, and `GNT`
///     4       1     version, 1
///     5       1     kind: 0 names, 1 values of 4 bytes (float), 2 values of 8 bytes (double)
///     6       2     count: values, or bytes of names
///     8       8     number, counted by the sender
///     16      8     time of the sender in ns, of any origin; -2^63: none
///     24      n     the values, a missing one is NaN; or the names in UTF-8, joined by commas
///     24 + n  4     CRC-32 (IEEE 802.3, as of zlib) of all bytes before
///
/// Names are sent first, and again from time to time. All frames have equally many values.
class BinaryFrames : public FrameDecoder {
 public:
  void Decode(std::string_view bytes, std::int64_t arrival_ns,
              const FrameReceiver& receive) override;
  void EndPacket(std::int64_t arrival_ns, const FrameReceiver& receive) override;
  void Restart() override;
  FrameFormat format() const override { return FrameFormat::kBinary; }

 private:
  /// Takes a frame, or bytes that are none, from the front of the buffer. False if it needs more.
  bool TakeFront(std::int64_t arrival_ns, const FrameReceiver& receive);
  void DecodeFrame(std::string_view frame, std::int64_t arrival_ns, const FrameReceiver& receive);
  void ReadNames(std::string_view text);
  void Skip(std::size_t bytes);

  std::string buffer_;
  bool is_in_garbage_ = false;  // which counts once
  std::vector<double> values_;
};

std::string BinaryFrame(const OutgoingFrame& frame);
/// Errors: UserError for names with a comma, or of more than 64 KB.
std::string BinaryNames(const std::vector<std::string>& names);

}  // namespace gauntlet::sim
