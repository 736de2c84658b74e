#include "sim/live/device/cyberglove_frames.h"

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
