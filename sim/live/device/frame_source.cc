#include "sim/live/device/frame_source.h"

#include <fmt/format.h>

#include <utility>

#include "sim/base/error.h"
#include "sim/base/text.h"
#include "sim/live/device/byte_device.h"
#include "sim/live/device/device_clock.h"
#include "sim/live/device/frame_decoder.h"
#include "sim/live/device/recording_source.h"

namespace gauntlet::sim {
namespace {

/// A device and the decoder of its bytes.
class DecodedSource : public FrameSource {
 public:
  DecodedSource(DeviceAddress address, std::unique_ptr<ByteDevice> device)
      : address_(std::move(address)),
        device_(std::move(device)),
        decoder_(MakeFrameDecoder(address_.format, device_->flow(), address_.osc_address)) {}
  ~DecodedSource() override {
    if (const std::string farewell = decoder_->Farewell(); !farewell.empty()) {
      device_->Write(farewell);
    }
  }

  State Wait(std::chrono::nanoseconds timeout, const FrameReceiver& receive) override {
    if (const std::string request = decoder_->Request(MonotonicNow_ns()); !request.empty()) {
      device_->Write(request);
    }
    const auto take = [&](const ArrivedBytes& arrived) {
      if (device_->counts().reopened != reopened_) {
        reopened_ = device_->counts().reopened;
        decoder_->Restart();
      }
      decoder_->Decode(arrived.bytes, arrived.arrival_ns, receive);
      if (device_->flow() == ByteFlow::kPackets) decoder_->EndPacket(arrived.arrival_ns, receive);
    };
    const State state = device_->Wait(timeout, take);
    if (state != State::kOpen) decoder_->Restart();
    return state;
  }

  const DeviceColumns& columns() const override { return decoder_->columns(); }
  SourceCounts counts() const override {
    SourceCounts counts = decoder_->counts();
    const SourceCounts& of_device = device_->counts();
    counts.foreign = of_device.foreign;
    counts.overflowed = of_device.overflowed;
    counts.reopened = of_device.reopened;
    counts.bytes = of_device.bytes;
    return counts;
  }
  std::string problem() const override {
    return device_->problem().empty() ? decoder_->problem() : device_->problem();
  }
  std::string Description() const override {
    const FrameFormat format = decoder_->format();
    const std::string facts = device_->Facts();
    return fmt::format("{}{}{}", Shown(address_.text),
                       format == FrameFormat::kDetect ? "" : fmt::format(", {}", WordOf(format)),
                       facts.empty() ? "" : ", " + facts);
  }

 protected:
  const DeviceAddress& address() const override { return address_; }

 private:
  DeviceAddress address_;
  std::unique_ptr<ByteDevice> device_;
  std::unique_ptr<FrameDecoder> decoder_;
  std::uint64_t reopened_ = 0;
};

}  // namespace

std::string FrameSource::AdviceWithoutFrames() const {
  const SourceCounts counted = counts();
  const DeviceAddress& at = address();
  const bool is_serial = at.kind == DeviceKind::kSerial;
  if (counted.bytes == 0) {
    std::string advice = "nothing arrives: ";
    if (is_serial) {
      advice += "is the glove switched on, and is this its port?";
    } else if (at.kind == DeviceKind::kUdp || at.kind == DeviceKind::kOsc) {
      advice += fmt::format(
          "does the sender send to this machine, port {}, and does a firewall "
          "let it in? 0.0.0.0 as host takes packets from other machines",
          at.port);
    } else {
      advice += "does the program on the left of the pipe write at once (stdbuf -oL)?";
    }
    return advice;
  }
  const std::string reason = problem();
  return fmt::format(
      "{} bytes arrived, and none is a frame{}; try {}a format behind a comma, as {},csv",
      counted.bytes, reason.empty() ? "" : fmt::format(" ({})", reason),
      is_serial ? "another baud rate behind @, or " : "", Shown(at.text));
}

std::unique_ptr<FrameSource> OpenFrameSource(const DeviceAddress& address,
                                             const SourceOptions& options) {
  switch (address.kind) {
    case DeviceKind::kFile:
      return OpenRecordingSource(address, options);
    case DeviceKind::kStdin:
      return std::make_unique<DecodedSource>(address, OpenStandardInput());
    case DeviceKind::kUdp:
    case DeviceKind::kOsc:
      return std::make_unique<DecodedSource>(address, OpenUdpListener(address));
    case DeviceKind::kSerial:
      return std::make_unique<DecodedSource>(address, OpenSerialPort(address));
    case DeviceKind::kNone:
    case DeviceKind::kStdout:
      break;
  }
  throw UserError({.place = Shown(address.text), .problem = "is no source of frames"});
}

}  // namespace gauntlet::sim
