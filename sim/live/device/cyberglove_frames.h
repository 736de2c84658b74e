#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "sim/live/device/frame_decoder.h"

namespace gauntlet::sim {

/// Frames of a CyberGlove with 18 or 22 sensors at 115200 baud:
///
///     47 or 53 (`G` or `S`), 18 or 22 bytes of 1 to 255, perhaps a byte of its switches, 00
///
/// Values are these bytes: counts of 8 bits. The number of bytes is that of the first two frames
/// that agree. Assumption: as programs of others read it, not the manual of the glove.
class CybergloveFrames : public FrameDecoder {
 public:
  enum class Mode {
    kPoll,    // sends `G` for each frame
    kStream,  // sends `S` once, and again after a second of silence; 03 at the end
  };

  explicit CybergloveFrames(Mode mode) : mode_(mode) {}

  void Decode(std::string_view bytes, std::int64_t arrival_ns,
              const FrameReceiver& receive) override;
  void EndPacket(std::int64_t arrival_ns, const FrameReceiver& receive) override;
  void Restart() override;
  std::string Request(std::int64_t now_ns) override;
  std::string Farewell() const override;
  FrameFormat format() const override {
    return mode_ == Mode::kPoll ? FrameFormat::kCyberglove : FrameFormat::kCybergloveStream;
  }

 private:
  void DecodeFrame(std::string_view frame, std::int64_t arrival_ns, const FrameReceiver& receive);

  Mode mode_;
  std::string rest_;             // of a frame without its end
  std::size_t frame_bytes_ = 0;  // 0: not known
  std::size_t last_bytes_ = 0;   // of the frame before
  std::vector<double> values_;
  bool is_answered_ = true;
  std::int64_t request_due_ns_ = 0;
};

}  // namespace gauntlet::sim
