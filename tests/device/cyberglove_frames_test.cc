#include "sim/live/device/cyberglove_frames.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/device/decoder_support.h"

namespace gauntlet::sim {
namespace {

/// A frame whose first sensor is `first`; the others are 2, 3 ...
std::string GloveFrame(char letter, int sensors, int first, bool has_switches = false) {
  std::string frame(1, letter);
  frame.push_back(static_cast<char>(first));
  for (int i = 2; i <= sensors; ++i) frame.push_back(static_cast<char>(i));
  if (has_switches) frame.push_back('\x03');
  frame.push_back('\0');
  return frame;
}

TEST(CybergloveFrames, AreThoseOfEachKindOfGlove) {
  for (const int sensors : {18, 22}) {
    for (const bool has_switches : {false, true}) {
      Decoded made(FrameFormat::kCyberglove, ByteFlow::kCutStream);
      for (const int first : {1, 71, 83, 255}) {  // `G` and `S` are values, too
        made.Decode(GloveFrame('G', sensors, first, has_switches));
      }
      ASSERT_EQ(made.frames.size(), 3u) << sensors << has_switches;
      ASSERT_EQ(std::ssize(made.frames[0].values), sensors);
      EXPECT_EQ(made.frames[0].values[0], 71.0);
      EXPECT_EQ(made.frames[2].values[0], 255.0);
      EXPECT_EQ(made.frames[2].values.back(), sensors);
      EXPECT_EQ(made.decoder->counts().garbage + made.decoder->counts().half_frames, 0u);
    }
  }
}

TEST(CybergloveFrames, AreLeftOutIfABytesIsLost) {
  const std::string good = GloveFrame('S', 22, 100);
  for (std::size_t lost = 0; lost < good.size(); ++lost) {
    std::string bad = good;
    bad.erase(lost, 1);
    Decoded made(FrameFormat::kCybergloveStream, ByteFlow::kCutStream);
    made.Decode("e?" + good).Decode(good).Decode(good).Decode(bad).Decode(good).Decode(good);
    EXPECT_GE(made.frames.size(), 2u) << lost;
    for (const KeptFrame& frame : made.frames) EXPECT_EQ(frame.values[0], 100.0) << lost;
    EXPECT_GE(made.decoder->counts().half_frames + made.decoder->counts().garbage, 2u);
  }
}

TEST(CybergloveFrames, OfNoGloveAreLeftOutByTheirSize) {
  for (int bytes = 0; bytes <= 40; ++bytes) {
    Decoded made(FrameFormat::kCyberglove, ByteFlow::kCutStream);
    const std::string frame = "G" + std::string(static_cast<std::size_t>(bytes), 'x') + '\0';
    made.Decode(frame).Decode(frame).Decode("x");
    const bool is_glove = bytes == 18 || bytes == 19 || bytes == 22 || bytes == 23;
    EXPECT_EQ(made.frames.size(), is_glove ? 1u : 0u) << bytes;
    if (is_glove) continue;
    // A line that is longer than any frame loses no bytes.
    EXPECT_EQ(made.decoder->counts().half_frames, bytes < 22 ? 2u : 0u) << bytes;
    EXPECT_EQ(made.decoder->counts().garbage, bytes < 22 ? 0u : 2u) << bytes;
    EXPECT_EQ(made.decoder->problem(), fmt::format("a frame has {} bytes", bytes + 1));
    made.decoder->Restart();
    EXPECT_EQ(made.decoder->counts().half_frames, bytes < 22 ? 3u : 1u) << bytes;
  }
  for (const std::size_t bytes : {256u, 257u}) {
    Decoded made(FrameFormat::kCyberglove, ByteFlow::kCutStream);
    made.Decode(std::string(bytes, 'x'));
    EXPECT_EQ(made.decoder->counts().garbage, bytes == 257 ? 1u : 0u);
  }
}

TEST(CybergloveFrames, OfAnotherGloveAreHalfOnes) {
  Decoded made(FrameFormat::kCyberglove, ByteFlow::kCutStream);
  for (const int sensors : {18, 18, 22, 18}) made.Decode(GloveFrame('G', sensors, 9));
  EXPECT_EQ(made.frames.size(), 2u);
  EXPECT_EQ(made.decoder->counts().half_frames, 1u);
  EXPECT_EQ(made.decoder->problem(), "a frame has 22 bytes, the first ones 18");
}

TEST(CybergloveFrames, AreAskedForOneByOne) {
  Decoded made(FrameFormat::kCyberglove, ByteFlow::kCutStream);
  EXPECT_EQ(made.decoder->Request(0), "G");
  EXPECT_EQ(made.decoder->Request(50'000'000), "") << "the answer is on its way";
  EXPECT_EQ(made.decoder->Request(100'000'000), "G") << "it was lost";
  made.Decode(GloveFrame('G', 18, 9));
  EXPECT_EQ(made.decoder->Request(100'000'001), "G");
  EXPECT_EQ(made.decoder->Farewell(), "");
}

TEST(CybergloveFrames, OfAStreamAreAskedForOnce) {
  Decoded made(FrameFormat::kCybergloveStream, ByteFlow::kCutStream);
  EXPECT_EQ(made.decoder->Request(0), "S");
  made.now_ns = 900'000'000;
  made.Decode(GloveFrame('S', 18, 9));
  EXPECT_EQ(made.decoder->Request(1'500'000'000), "");
  EXPECT_EQ(made.decoder->Request(2'000'000'000), "S") << "silent for a second";
  EXPECT_EQ(made.decoder->Farewell(), "\x03");
}

}  // namespace
}  // namespace gauntlet::sim
