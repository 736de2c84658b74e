#include "sim/live/device/osc_frames.h"

#include <gmock/gmock.h>

#include <cmath>
#include <string>

#include "sim/base/error.h"
#include "sim/tables/missing.h"
#include "tests/device/decoder_support.h"

namespace gauntlet::sim {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

Decoded Osc(const std::string& address) { return {FrameFormat::kOsc, ByteFlow::kPackets, address}; }

/// Bytes that Debian's `oscsend host port /glove/right ifs 1 0.5 ab` (liblo 0.31) sent.
const std::string kOfLiblo(
    "\x2f\x67\x6c\x6f\x76\x65\x2f\x72\x69\x67\x68\x74\x00\x00\x00\x00"
    "\x2c\x69\x66\x73\x00\x00\x00\x00\x00\x00\x00\x01\x3f\x00\x00\x00\x61\x62\x00\x00",
    36);

TEST(OscPacket, OfLibloIsRead) {
  const auto packet = ReadOscPacket(kOfLiblo);
  ASSERT_TRUE(packet);
  ASSERT_EQ(packet->messages.size(), 1u);
  EXPECT_EQ(packet->messages[0].address, "/glove/right");
  EXPECT_THAT(packet->messages[0].numbers, ElementsAre(1.0, 0.5));
  EXPECT_FALSE(packet->is_bundle);
}

TEST(OscPacket, IsReadWholeOrNotAtAll) {
  const std::string bundle = OscBundleBytes({{"/a/b", {1.0, 2.5}}, {"/a/c", {kMissing}}});
  ASSERT_TRUE(ReadOscPacket(bundle));
  for (std::size_t size = 0; size < bundle.size(); ++size) {
    const auto part = ReadOscPacket(bundle.substr(0, size));
    // The head of a bundle alone, or with its first message, is a bundle, too.
    EXPECT_LE(part ? part->messages.size() : 0, 1u) << size;
  }
  EXPECT_FALSE(ReadOscPacket(kOfLiblo + std::string(4, '\0')));
  EXPECT_FALSE(ReadOscPacket("/abc"));
  std::string negative("#bundle\0\0\0\0\0\0\0\0\1\xff\xff\xff\xf0", 20);
  EXPECT_FALSE(ReadOscPacket(negative));
}

TEST(OscPacket, HasAllTypesOfNumbers) {
  std::string bytes("/a\0\0,ihdfTFNIbt\0", 16);
  bytes += std::string("\xff\xff\xff\xfe\0\0\0\0\0\0\0\5\x40\x04\0\0\0\0\0\0\x3f\x80\0\0", 24);
  bytes += std::string("\0\0\0\2zz\0\0\0\0\0\1\0\0\0\0", 16);
  const auto packet = ReadOscPacket(bytes);
  ASSERT_TRUE(packet);
  const std::vector<double>& numbers = packet->messages[0].numbers;
  ASSERT_EQ(numbers.size(), 7u);
  EXPECT_THAT(std::vector(numbers.begin(), numbers.end() - 1),
              ElementsAre(-2.0, 5.0, 2.5, 1.0, 1.0, 0.0));
  EXPECT_TRUE(std::isnan(numbers[6]));
}

/// A character, a colour, a MIDI message, texts and a list have no number, and the size of theirs.
TEST(OscPacket, PassesOverWhatIsNoNumber) {
  const std::string bytes = std::string("/a\0\0,crmsS[i]I\0\0\0", 18) + std::string(2, '\0') +
                            std::string("\0\0\0aRGBAmidiab\0\0abcd\0\0\0\0\0\0\0\7", 28);
  const auto packet = ReadOscPacket(bytes);
  ASSERT_TRUE(packet);
  EXPECT_THAT(packet->messages[0].numbers, ElementsAre(7.0));
  EXPECT_FALSE(ReadOscPacket(std::string("/a\0\0,?\0\0", 8)));
}

TEST(OscPacket, PassesOverBlobsOfEachLength) {
  for (char length = 0; length <= 9; ++length) {
    const std::size_t padded = (static_cast<std::size_t>(length) + 3) / 4 * 4;
    const std::string bytes = std::string("/a\0\0,bi\0\0\0\0", 11) + length +
                              std::string(padded, 'x') + std::string("\0\0\0\7", 4);
    const auto packet = ReadOscPacket(bytes);
    ASSERT_TRUE(packet) << static_cast<int>(length);
    EXPECT_THAT(packet->messages[0].numbers, ElementsAre(7.0));
  }
}

TEST(OscPacket, HasBundlesInBundlesUpToEight) {
  std::string bytes("/a\0\0,i\0\0\0\0\0\7", 12);
  for (int depth = 1; depth <= 9; ++depth) {
    bytes = std::string("#bundle\0\0\0\0\0\0\0\0\1\0\0\0", 19) + static_cast<char>(bytes.size()) +
            bytes;
    EXPECT_EQ(ReadOscPacket(bytes).has_value(), depth <= 8) << depth;
  }
}

TEST(OscPacket, MayLeaveOutTheTypesOfNoArguments) {
  const auto packet = ReadOscPacket({"/a\0\0", 4});
  ASSERT_TRUE(packet);
  EXPECT_EQ(packet->messages.at(0).address, "/a");
  EXPECT_THAT(packet->messages[0].numbers, IsEmpty());
}

/// 2^31 of 2^32 parts of a second after 1970 began, which is 2208988800 s after 1900 did.
TEST(OscPacket, HasTheTimeOfItsBundle) {
  const auto packet = ReadOscPacket({"#bundle\0\x83\xaa\x7e\x81\x80\0\0\0", 16});
  ASSERT_TRUE(packet);
  EXPECT_EQ(packet->time_ns, 1'500'000'000);
}

TEST(OscFrames, OfAnAddressAreItsMessages) {
  Decoded made = Osc("/glove/right");
  made.step_ns = 10'000'000;
  for (int i = 0; i < 5; ++i) {
    made.Packet(OscMessageBytes("/glove/left", {9.0, 9.0}));
    made.Packet(OscMessageBytes("/glove/right", {512.0 + i, 0.5}));
  }
  made.Packet(OscMessageBytes("/glove/right", {1.0}));
  EXPECT_EQ(made.Values(), (Rows{{512, 0.5}, {513, 0.5}, {514, 0.5}, {515, 0.5}, {516, 0.5}}));
  EXPECT_THAT(made.decoder->columns().names, ElementsAre("right_1", "right_2"));
  EXPECT_EQ(made.decoder->counts().garbage, 1u);
  EXPECT_EQ(made.frames[0].arrival_ns, 20'000'000);
}

TEST(OscFrames, HaveAtMost1024Columns) {
  for (const std::size_t columns : {1024, 1025}) {
    Decoded made = Osc("/flex");
    for (int i = 0; i < 5; ++i) {
      made.Packet(OscMessageBytes("/flex", std::vector<double>(columns, 1.0)));
    }
    EXPECT_EQ(made.frames.size(), columns == 1024 ? 5u : 0u);
  }
}

TEST(OscFrames, HaveTheWidthThatComesTwice) {
  Decoded made = Osc("/flex");
  for (const std::size_t width : {1, 2, 2, 3, 2}) {
    made.Packet(OscMessageBytes("/flex", std::vector<double>(width, 5.0)));
  }
  EXPECT_EQ(made.Values(), (Rows{{5, 5}, {5, 5}, {5, 5}}));
  EXPECT_EQ(made.decoder->counts().garbage, 2u);
  EXPECT_EQ(made.decoder->problem(), "a message has 3 numbers, the first one 2");
}

TEST(OscFrames, OfABundleAreItsMessages) {
  Decoded made = Osc("");
  for (int i = 0; i < 3; ++i) {
    made.Packet(OscBundleBytes({{"/glove/thumb", {1.0 * i}}, {"/glove/index", {10.0 * i}}}));
  }
  EXPECT_EQ(made.Values(), (Rows{{0, 0}, {1, 10}, {2, 20}}));
  EXPECT_THAT(made.decoder->columns().names, ElementsAre("thumb", "index"));
}

/// One message for each finger, of which one is lost: the next frame is whole again.
TEST(OscFrames, OfManyAddressesEndWhenOneComesAgain) {
  Decoded made = Osc("/hand/*");
  for (int i = 0; i < 6; ++i) {
    made.Packet(OscMessageBytes("/hand/thumb/tip", {1.0 + i}));
    if (i != 4) made.Packet(OscMessageBytes("/hand/index/tip", {11.0 + i}));
    made.Packet(OscMessageBytes("/battery", {3.7}));
    made.Packet(OscMessageBytes("/hand/ring/tip", {21.0 + i}));
  }
  ASSERT_EQ(made.frames.size(), 6u);
  EXPECT_THAT(made.decoder->columns().names, ElementsAre("thumb_tip", "index_tip", "ring_tip"));
  EXPECT_EQ(made.frames[3].values, (std::vector{4.0, 14.0, 24.0}));
  EXPECT_EQ(made.frames[4].values[0], 5.0);
  EXPECT_TRUE(std::isnan(made.frames[4].values[1])) << "lost, not repeated";
  EXPECT_EQ(made.frames[4].values[2], 25.0);
  EXPECT_EQ(made.frames[5].values, (std::vector{6.0, 16.0, 26.0}));
}

TEST(OscFrames, OfSeveralAddressesNeedAChoice) {
  Decoded made = Osc("");
  made.Packet(OscMessageBytes("/glove/thumb", {1.0}));
  made.Packet(OscMessageBytes("/glove/thumb", {1.0}));
  made.Packet(OscMessageBytes("/glove/thumb", {1.0}));
  EXPECT_THAT(made.frames, IsEmpty()) << "others may follow";
  try {
    made.Packet(OscMessageBytes("/glove/index", {1.0}));
    FAIL() << "took a part of a glove for all of it";
  } catch (const UserError& error) {
    EXPECT_THAT(error.what(), HasSubstr("(/glove/thumb, /glove/index)"));
  }
  Decoded single = Osc("");
  single.step_ns = 50'000'000;
  for (int i = 0; i < 6; ++i) single.Packet(OscMessageBytes("/flex", {1.0, 2.0}));
  EXPECT_EQ(single.frames.size(), 6u);
}

/// A receiver may ask for the columns of the frame that it gets, also of the first one.
TEST(OscFrames, HaveTheirColumnsFromTheFirstOn) {
  const auto decoder = MakeFrameDecoder(FrameFormat::kDetect, ByteFlow::kPackets);
  int frames = 0;
  for (std::int64_t i = 0; i < 30; ++i) {
    decoder->Decode(OscMessageBytes("/flex", {1.0, 2.0}), 10'000'000 * i, {});
    decoder->EndPacket(10'000'000 * i, [&](const DeviceFrame& frame) {
      ++frames;
      EXPECT_EQ(decoder->columns().count, frame.values.size());
      EXPECT_THAT(decoder->columns().names, ElementsAre("flex_1", "flex_2"));
    });
  }
  EXPECT_EQ(frames, 30);
}

TEST(OscFrames, HaveNamesOfAnyAddresses) {
  for (const std::string first : {"/", "//", "/a", "/a/", "/a/b"}) {
    for (const std::string second : {"/", "//", "/a", "/a/", "/a/b", "/b"}) {
      Decoded made = Osc("");
      for (int i = 0; i < 2; ++i) made.Packet(OscBundleBytes({{first, {1.0}}, {second, {2.0}}}));
      EXPECT_FALSE(made.frames.empty()) << first << " " << second;
    }
  }
}

}  // namespace
}  // namespace gauntlet::sim
