#include "sim/live/device/cyberglove_frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "sim/live/device/device_clock.h"

namespace gauntlet::sim {
namespace {

constexpr char kPoll = 'G';
constexpr char kStream = 'S';
constexpr char kStop = '\x03';

/// Bytes between the first letter and the zero: sensors, without and with the switches.
constexpr std::array<std::size_t, 4> kSizes = {18, 19, 22, 23};
constexpr std::size_t kLongestFrame = 256;

std::size_t SensorsIn(std::size_t bytes) { return bytes < 22 ? 18 : 22; }

}  // namespace

std::string CybergloveFrames::Request(std::int64_t now_ns) {
  constexpr std::int64_t kSilence_ns = kNanosecondsPerSecond;
  constexpr std::int64_t kLongestAnswer_ns = kNanosecondsPerSecond / 10;
  const bool is_due = now_ns >= request_due_ns_ || (mode_ == Mode::kPoll && is_answered_);
  if (!is_due) return {};
  is_answered_ = false;
  request_due_ns_ = now_ns + (mode_ == Mode::kPoll ? kLongestAnswer_ns : kSilence_ns);
  return std::string(1, mode_ == Mode::kPoll ? kPoll : kStream);
}

std::string CybergloveFrames::Farewell() const {
  return mode_ == Mode::kStream ? std::string(1, kStop) : std::string();
}

void CybergloveFrames::Decode(std::string_view bytes, std::int64_t arrival_ns,
                              const FrameReceiver& receive) {
  // No byte of a frame but its last one is zero.
  while (!bytes.empty()) {
    const std::size_t end = bytes.find('\0');
    rest_.append(bytes.substr(0, end));
    if (rest_.size() > kLongestFrame) {
      CountGarbage("bytes without the zero at the end of a frame");
      rest_.clear();
    }
    if (end == std::string_view::npos) return;
    bytes.remove_prefix(end + 1);
    DecodeFrame(std::exchange(rest_, {}), arrival_ns, receive);
  }
}

void CybergloveFrames::DecodeFrame(std::string_view frame, std::int64_t arrival_ns,
                                   const FrameReceiver& receive) {
  const bool has_letter = frame.starts_with(kPoll) || frame.starts_with(kStream);
  const std::size_t size = frame.size() - (has_letter ? 1 : 0);
  if (!has_letter || std::ranges::find(kSizes, size) == kSizes.end()) {
    if (frame.size() < kSizes.back()) {
      CountHalf(fmt::format("a frame has {} bytes", frame.size()));
    } else {
      CountGarbage(fmt::format("a frame has {} bytes", frame.size()));
    }
    return;
  }
  is_answered_ = true;
  request_due_ns_ = arrival_ns + kNanosecondsPerSecond;
  if (frame_bytes_ == 0 && size == last_bytes_) {
    frame_bytes_ = size;
    columns_.count = SensorsIn(size);
    values_.resize(columns_.count);
    NameColumns({});
  }
  last_bytes_ = size;
  if (frame_bytes_ == 0) return;
  if (size != frame_bytes_) {
    CountHalf(fmt::format("a frame has {} bytes, the first ones {}", size, frame_bytes_));
    return;
  }
  for (std::size_t i = 0; i < values_.size(); ++i) {
    values_[i] = static_cast<unsigned char>(frame[i + 1]);
  }
  Emit(values_, arrival_ns, receive);
}

void CybergloveFrames::EndPacket(std::int64_t /*arrival_ns*/, const FrameReceiver& /*receive*/) {
  if (!rest_.empty()) CountHalf("a frame has no end");
  rest_.clear();
}

void CybergloveFrames::Restart() {
  EndPacket(0, {});
  is_answered_ = true;
  request_due_ns_ = 0;
}

}  // namespace gauntlet::sim
