#include "sim/live/device/binary_frames.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <string>

#include "sim/base/error.h"
#include "tests/device/decoder_support.h"

namespace gauntlet::sim {
namespace {

using testing::ElementsAre;

Decoded Binary(ByteFlow flow = ByteFlow::kCutStream) { return {FrameFormat::kDetect, flow}; }

std::string FrameNumber(std::int64_t number) {
  const std::vector<double> values = {512.0 + static_cast<double>(number), 0.5};
  return BinaryFrame({.number = number, .time_ns = 1000 * number, .values = values});
}

/// The checksum of these bytes is from Python: binascii.crc32().
TEST(BinaryFrames, HaveTheBytesOfTheirDescription) {
  const std::vector<double> values = {1.0};
  EXPECT_EQ(BinaryFrame({.number = 258, .time_ns = 7, .values = values}),
            std::string("\xF7GNT\x01\x02\x01\x00"
                        "\x02\x01\x00\x00\x00\x00\x00\x00"
                        "\x07\x00\x00\x00\x00\x00\x00\x00"
                        "\x00\x00\x00\x00\x00\x00\xF0\x3F"
                        "\x47\x96\x4C\x16",
                        36));
}

TEST(BinaryFrames, AreReadAsTheyWereWritten) {
  const std::vector<double> values = {512.25, std::numeric_limits<double>::quiet_NaN(), -1e300,
                                      std::numeric_limits<double>::infinity()};
  Decoded made = Binary();
  made.Decode(BinaryNames({"a", "b", "c", "d"}))
      .Decode(BinaryFrame({.number = -5, .time_ns = 1'700'000'000'123'456'789, .values = values}));
  ASSERT_EQ(made.frames.size(), 1u);
  EXPECT_EQ(made.decoder->format(), FrameFormat::kBinary);
  EXPECT_THAT(made.decoder->columns().names, ElementsAre("a", "b", "c", "d"));
  EXPECT_EQ(made.frames[0].number, -5);
  EXPECT_EQ(made.frames[0].sender_time_ns, 1'700'000'000'123'456'789);
  EXPECT_EQ(made.frames[0].values[0], 512.25);
  EXPECT_TRUE(std::isnan(made.frames[0].values[1]));
  EXPECT_EQ(made.frames[0].values[2], -1e300);
  EXPECT_TRUE(std::isnan(made.frames[0].values[3]));
}

TEST(BinaryFrames, HaveNamesOfUpTo65535Bytes) {
  EXPECT_EQ(BinaryNames({std::string(65'000, 'a'), std::string(534, 'b')}).size(), 65'535u + 28u);
  EXPECT_THROW(BinaryNames({std::string(65'000, 'a'), std::string(535, 'b')}), UserError);
  EXPECT_THROW(BinaryNames({"a,b"}), UserError);
}

TEST(BinaryFrames, DoNotDependOnThePiecesOfTheStream) {
  const std::string bytes = "boot\n" + FrameNumber(1) + "noise" + FrameNumber(2) + FrameNumber(3);
  for (std::size_t size = 1; size <= bytes.size(); ++size) {
    Decoded made = Binary();
    for (std::size_t at = 0; at < bytes.size(); at += size) made.Decode(bytes.substr(at, size));
    ASSERT_EQ(made.frames.size(), 3u) << size;
    EXPECT_EQ(made.frames[2].number, 3);
    EXPECT_EQ(made.decoder->counts().garbage, 2u) << size;
  }
}

/// One byte of a frame is changed or lost: no other frame suffers, and no wrong one comes.
TEST(BinaryFrames, AreRightOrLeftOut) {
  const std::string good = FrameNumber(2);
  for (std::size_t at = 0; at < good.size(); ++at) {
    for (const bool is_lost : {false, true}) {
      std::string bad = good;
      if (is_lost)
        bad.erase(at, 1);
      else
        bad[at] = static_cast<char>(bad[at] ^ 0x10);
      Decoded made = Binary();
      made.Decode(FrameNumber(1) + bad + FrameNumber(3) + FrameNumber(4) + std::string(9000, 'x'));
      std::vector<std::int64_t> numbers;
      for (const KeptFrame& frame : made.frames) numbers.push_back(frame.number.value());
      EXPECT_THAT(numbers, ElementsAre(1, 3, 4)) << at << is_lost;
      for (const KeptFrame& frame : made.frames) {
        EXPECT_EQ(frame.values[0], 512.0 + static_cast<double>(*frame.number));
      }
    }
  }
}

TEST(BinaryFrames, OfPacketsDoNotGoOnInTheNextOne) {
  const std::string frame = FrameNumber(1);
  Decoded made = Binary(ByteFlow::kPackets);
  made.Packet(frame).Packet(frame.substr(0, 20)).Packet(frame.substr(20)).Packet(frame + frame);
  EXPECT_EQ(made.frames.size(), 3u);
  EXPECT_EQ(made.decoder->counts().half_frames, 1u);
  EXPECT_EQ(made.decoder->counts().garbage, 1u);
}

TEST(BinaryFrames, OfAnotherWidthAreLeftOut) {
  const std::vector<double> other = {1.0, 2.0, 3.0};
  Decoded made = Binary();
  made.Decode(FrameNumber(1) + BinaryFrame({.number = 2, .values = other}) +
              BinaryNames({"a", "b", "c"}) + FrameNumber(3));
  EXPECT_EQ(made.frames.size(), 2u);
  EXPECT_EQ(made.decoder->counts().garbage, 2u);
  EXPECT_TRUE(made.decoder->columns().names.empty());
}

}  // namespace
}  // namespace gauntlet::sim
