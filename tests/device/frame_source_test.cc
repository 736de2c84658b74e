#include "sim/device/frame_source.h"

#include <gtest/gtest.h>

#include <vector>

#include "sim/device/frame_sink.h"

namespace gauntlet::sim {
namespace {

using std::chrono::milliseconds;

TEST(FrameSource, ReceivesOverUdpWhatASinkSends) {
  const std::string at = "udp:127.0.0.1:47123";
  const auto source = OpenFrameSource(ParseDeviceAddress(at, DeviceRole::kSource));
  const auto sink = OpenFrameSink(ParseDeviceAddress(at, DeviceRole::kSink), {"a", "b"});
  std::vector<std::int64_t> numbers;
  for (int i = 0; i < 5; ++i) {
    const std::vector<double> values = {512.0 + i, -3.0};
    EXPECT_EQ(sink->Send({.number = i, .time_ns = 1'000'000'007 + i, .values = values}),
              FrameSink::Result::kSent);
    source->Wait(milliseconds(1000), [&](const DeviceFrame& frame) {
      numbers.push_back(frame.number.value());
      EXPECT_EQ(frame.sender_time_ns, 1'000'000'007 + frame.number.value());
      EXPECT_EQ(frame.values[2], 512.0 + static_cast<double>(frame.number.value()));
    });
    source->Wait(milliseconds(20),
                 [&](const DeviceFrame& frame) { numbers.push_back(frame.number.value()); });
  }
  EXPECT_EQ(numbers, (std::vector<std::int64_t>{0, 1, 2, 3, 4}));
}

}  // namespace
}  // namespace gauntlet::sim
