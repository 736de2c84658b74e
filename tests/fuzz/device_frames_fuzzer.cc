// Bytes of devices, on their way to the counts of a glove as in a live session. The first byte of
// an input chooses format and flow, the second the length of the pieces; the rest is what arrives,
// in which a byte of 0x1E ends a packet or opens the device again.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "sim/base/error.h"
#include "sim/base/text.h"
#include "sim/live/device/frame_decoder.h"
#include "sim/live/frame_arrivals.h"
#include "sim/live/frame_channels.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace gauntlet::sim;  // NOLINT(google-build-using-namespace)
  if (size < 2) return 0;
  constexpr int kFormats = static_cast<int>(FrameFormat::kOsc) + 1;
  const auto format = static_cast<FrameFormat>(data[0] % kFormats);
  const auto flow = static_cast<ByteFlow>(data[0] / kFormats % 3);
  const std::string address = data[0] / kFormats / 3 % 2 == 0 ? "" : "/a*";
  const std::size_t piece = data[1] % 16 + 1;
  std::string_view bytes(reinterpret_cast<const char*>(data) + 2, size - 2);

  const auto decoder = MakeFrameDecoder(format, flow, address);
  FrameArrivals arrivals;
  FrameChannels channels({.glove = {.channel_names = {"a", "b"},
                                    .low_counts = {0.0, 100.0},
                                    .high_counts = {1023.0, 900.0},
                                    .low_angle_rad = {0.0, -0.5},
                                    .high_angle_rad = {1.5, 1.0}},
                          .source = "--glove fuzzed"});
  std::uint64_t frames = 0;
  const auto receive = [&](const DeviceFrame& frame) {
    ++frames;
    // A frame has the values of the columns, none of them infinite.
    if (frame.values.empty() || frame.values.size() != decoder->columns().count) std::abort();
    if (std::ranges::any_of(frame.values, [](double value) { return std::isinf(value); })) {
      std::abort();
    }
    const auto& names = decoder->columns().names;
    if (!names.empty() && names.size() != frame.values.size()) std::abort();
    for (const std::string& name : names) {
      if (!TextProblem(name).empty()) std::abort();
    }
    arrivals.Add(frame);
    const double time_s = 1e-3 * static_cast<double>(frames);
    try {
      if (channels.Counts(decoder->columns(), time_s, frame.values).size() != 2) std::abort();
    } catch (const UserError&) {  // columns of no glove
    }
  };
  std::int64_t now_ns = 0;
  try {
    while (!bytes.empty()) {
      std::string_view packet = bytes.substr(0, bytes.find('\x1E'));
      bytes.remove_prefix(std::min(packet.size() + 1, bytes.size()));
      while (!packet.empty()) {
        const std::string_view taken = packet.substr(0, piece);
        packet.remove_prefix(taken.size());
        decoder->Decode(taken, now_ns += 100'000'000, receive);
        decoder->Request(now_ns);
      }
      if (flow == ByteFlow::kPackets) {
        decoder->EndPacket(now_ns, receive);
      } else if (!bytes.empty()) {
        decoder->Restart();
      }
    }
  } catch (const UserError&) {  // several addresses of OSC
  }
  if (frames != decoder->counts().frames) std::abort();
  return 0;
}
