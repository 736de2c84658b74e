#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/live/device/frame_decoder.h"

namespace gauntlet::sim {

/// A frame that was received, with values of its own.
struct KeptFrame {
  std::int64_t arrival_ns = 0;
  std::optional<std::int64_t> number = {};
  std::optional<std::int64_t> sender_time_ns = {};
  std::vector<double> values = {};
};

/// A receiver that appends frames.
inline FrameReceiver Into(std::vector<KeptFrame>& frames) {
  return [&frames](const DeviceFrame& frame) {
    frames.push_back({frame.arrival_ns,
                      frame.number,
                      frame.sender_time_ns,
                      {frame.values.begin(), frame.values.end()}});
  };
}

/// A decoder and the frames that it made.
struct Decoded {
  Decoded(FrameFormat format, ByteFlow flow, const std::string& osc_address = {})
      : decoder(MakeFrameDecoder(format, flow, osc_address)) {}

  /// Bytes of a stream, which arrive `step_ns` after those before.
  Decoded& Decode(std::string_view bytes) {
    decoder->Decode(bytes, now_ns += step_ns, Into(frames));
    return *this;
  }
  Decoded& Packet(std::string_view bytes) {
    Decode(bytes);
    decoder->EndPacket(now_ns, Into(frames));
    return *this;
  }
  std::vector<std::vector<double>> Values() const {
    std::vector<std::vector<double>> values;
    for (const KeptFrame& frame : frames) values.push_back(frame.values);
    return values;
  }

  std::unique_ptr<FrameDecoder> decoder;
  std::vector<KeptFrame> frames;
  std::int64_t now_ns = 0;
  std::int64_t step_ns = 1'000'000;
};

using Rows = std::vector<std::vector<double>>;

}  // namespace gauntlet::sim
