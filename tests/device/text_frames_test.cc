#include "sim/live/device/text_frames.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <string>

#include "sim/live/device/sender_clock.h"
#include "tests/device/decoder_support.h"

namespace gauntlet::sim {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

Decoded Serial(FrameFormat format = FrameFormat::kDetect) { return {format, ByteFlow::kCutStream}; }
Decoded Stream(FrameFormat format = FrameFormat::kDetect) {
  return {format, ByteFlow::kWholeStream};
}

TEST(TextFrames, OfCsvAreRowsBelowNames) {
  Decoded made = Stream();
  made.Decode("frame,t_ms,flex1,flex2\n7,1000.5,512,300\n").Decode("8,1010.5,513,\n");
  ASSERT_EQ(made.frames.size(), 2u);
  EXPECT_EQ(made.decoder->format(), FrameFormat::kCsv);
  EXPECT_THAT(made.decoder->columns().names, ElementsAre("frame", "t_ms", "flex1", "flex2"));
  EXPECT_EQ(made.frames[0].number, 7);
  EXPECT_EQ(made.frames[0].sender_time_ns, 1'000'500'000);
  EXPECT_EQ(made.frames[0].values, (std::vector{7.0, 1000.5, 512.0, 300.0}));
  EXPECT_EQ(made.frames[1].arrival_ns, 2'000'000);
  EXPECT_TRUE(std::isnan(made.frames[1].values[3])) << "a missing value is no number";
  EXPECT_EQ(made.decoder->counts().garbage + made.decoder->counts().half_frames, 0u);
}

TEST(TextFrames, MayEndWithASeparator) {
  EXPECT_EQ(Stream().Decode("flex1,flex2,\n1,2,\n3,4,\n").Values(), (Rows{{1, 2}, {3, 4}}));
  EXPECT_EQ(Stream().Decode("flex1,\n512,\n513,\n").Values(), (Rows{{512}, {513}}));
}

/// The same bytes give the same frames in any pieces.
TEST(TextFrames, DoNotDependOnThePiecesOfTheStream) {
  const std::string text = "a,b\r\n1,2\r\n\r\n# note\r\n3,4\r\n5,x\r\n6,7\r\n";
  for (std::size_t size = 1; size <= text.size(); ++size) {
    Decoded made = Stream();
    for (std::size_t at = 0; at < text.size(); at += size) made.Decode(text.substr(at, size));
    EXPECT_EQ(made.Values(), (Rows{{1, 2}, {3, 4}, {6, 7}})) << size;
    EXPECT_EQ(made.decoder->counts().garbage, 1u) << size;
  }
}

TEST(TextFrames, PassOverBootMessagesAndACutLine) {
  Decoded made = Serial();
  made.Decode(
          "45,678\nets Jun  8 2016 00:22:57\nrst:0x1 (POWERON_RESET),boot:0x13\nload:0x3f,len:4\n")
      .Decode("load:0x40,len:12\nMPU ready\n1,2,3\n4,5,6\n7,8\n9,10,11,12\n13,14,15\n");
  EXPECT_EQ(made.Values(), (Rows{{1, 2, 3}, {4, 5, 6}, {13, 14, 15}}));
  EXPECT_EQ(made.decoder->counts().half_frames, 1u);
  EXPECT_EQ(made.decoder->counts().garbage, 6u);
  EXPECT_THAT(made.decoder->columns().names, IsEmpty());
}

/// What remains of a first line may look like a line: its first value is none.
TEST(TextFrames, TakeNoValueOfTheFirstLineOfASerialLine) {
  EXPECT_EQ(Serial().Decode("2,300\n512,300\n511,301\n").Values(), (Rows{{512, 300}, {511, 301}}));
  EXPECT_EQ(Stream().Decode("512,300\n511,301\n").Values(), (Rows{{512, 300}, {511, 301}}));
}

TEST(TextFrames, AreNeverMadeOfPartsOfTwo) {
  Decoded made = Serial();
  made.Decode("\n1,2\n3,4\n5,");
  made.decoder->Restart();  // the device went away and came back
  made.Decode("6\n7,8\n");
  EXPECT_EQ(made.Values(), (Rows{{1, 2}, {3, 4}, {7, 8}}));
  EXPECT_EQ(made.decoder->counts().half_frames, 1u);
  Decoded packets(FrameFormat::kCsv, ByteFlow::kPackets);
  packets.Packet("1,2").Packet("3,4").Packet("5,").Packet("6").Packet("7,8");
  EXPECT_EQ(packets.Values().front(), (std::vector{1.0, 2.0}));
  EXPECT_EQ(packets.Values().back(), (std::vector{7.0, 8.0}));
  for (const auto& values : packets.Values()) EXPECT_NE(values, (std::vector{5.0, 6.0}));
}

TEST(TextFrames, LearnNamesThatAreSentLater) {
  Decoded made(FrameFormat::kDetect, ByteFlow::kPackets);
  made.Packet("1,2").Packet("3,4");
  EXPECT_THAT(made.decoder->columns().names, IsEmpty());
  made.Packet("k,flex\n").Packet("5,6").Packet("k,flex").Packet("k,other").Packet("7,8");
  EXPECT_THAT(made.decoder->columns().names, ElementsAre("k", "flex"));
  EXPECT_EQ(made.Values(), (Rows{{1, 2}, {3, 4}, {5, 6}, {7, 8}}));
  EXPECT_EQ(made.frames.back().number, 7);
  EXPECT_EQ(made.decoder->counts().garbage, 1u) << "other names may be another device";
}

TEST(TextFrames, ReadDecimalCommasTabsAndOneColumn) {
  EXPECT_EQ(Stream().Decode("a;b\n1,5;2\n").Values(), (Rows{{1.5, 2}}));
  EXPECT_EQ(Stream().Decode("1\t2\n3\t4\n").Values(), (Rows{{1, 2}, {3, 4}}));
  EXPECT_EQ(Stream().Decode("flex\n512\n513\n").Values(), (Rows{{512}, {513}}));
  EXPECT_THAT(Serial().Decode("\nready\n512\n513\n").decoder->columns().names, IsEmpty());
}

/// A last value may be missing in the first row, and a separator may end each line.
TEST(TextFrames, HaveALastColumnThatIsMissing) {
  Decoded made = Stream();
  made.Decode("a,b\n1,\n2,\n3,4\n");
  ASSERT_EQ(made.frames.size(), 3u);
  EXPECT_THAT(made.decoder->columns().names, ElementsAre("a", "b"));
  EXPECT_TRUE(std::isnan(made.frames[0].values[1]));
  EXPECT_EQ(made.frames[2].values, (std::vector{3.0, 4.0}));
  EXPECT_EQ(Stream().Decode("a,b,\n1,2,\n3,4,\n").Values(), (Rows{{1, 2}, {3, 4}}));
  EXPECT_EQ(Stream().Decode("a,b\n1,2,\n3,4,\n").Values(), (Rows{{1, 2}, {3, 4}}));
}

TEST(TextFrames, AreLabelsOfASerialPlotter) {
  Decoded made = Serial();
  made.Decode("ex1:5 flex2:3\nflex1:512 flex2:300\nflex1:511 flex2:301\nflex1:510 flex2:302\n")
      .Decode("flex1:5\nflex1:509 flex2:303\n");
  EXPECT_EQ(made.decoder->format(), FrameFormat::kLabels);
  EXPECT_THAT(made.decoder->columns().names, ElementsAre("flex1", "flex2"));
  EXPECT_EQ(made.Values(), (Rows{{512, 300}, {511, 301}, {510, 302}, {509, 303}}));
  EXPECT_EQ(made.decoder->counts().garbage, 1u);
}

/// Source: lucidgloves, AlphaEncoding.cpp: fingers, joystick, trigger, flags, splay.
TEST(TextFrames, AreTheAlphaEncodingOfLucidgloves) {
  Decoded made = Serial();
  made.Decode("B12C3D4E5F6G7P8\n");
  for (int i = 0; i < 3; ++i) {
    made.Decode(fmt::format("A{}B200C300D400E500F2048G2047P5HJ(AB)10(BB)20\n", 100 + i));
  }
  made.Decode("A9B20");
  made.Decode("0C300D4\n").Decode("A104B200C300D400E500F2048G2047P5\n");
  EXPECT_EQ(made.decoder->format(), FrameFormat::kAlpha);
  ASSERT_EQ(made.frames.size(), 4u);
  EXPECT_EQ(made.frames[0].values, (std::vector<double>{100, 200, 300, 400, 500, 2048, 2047, 5}));
  EXPECT_EQ(made.frames[3].values[0], 104.0);
  EXPECT_EQ(made.decoder->columns().names.front(), "thumb");
  EXPECT_EQ(made.decoder->counts().garbage, 1u);
}

TEST(TextFrames, HaveListsInTheirCells) {
  Decoded made = Stream();
  made.Decode("boot\nt_s,flex\n0.0,[512 300]\n0.1,\"[511, 301]\"\n0.2,[5]\n0.3,[510 302]\n");
  EXPECT_EQ(made.decoder->format(), FrameFormat::kCsv);
  EXPECT_THAT(made.decoder->columns().names, ElementsAre("t_s", "flex_1", "flex_2"));
  EXPECT_EQ(made.Values(), (Rows{{0.0, 512, 300}, {0.1, 511, 301}, {0.3, 510, 302}}));
  EXPECT_EQ(made.decoder->counts().garbage, 2u);
}

TEST(TextFrames, ArePrintedJointStates) {
  Decoded made = Stream();
  made.Decode("%time,field.header.seq,field.name0,field.position0\n1500000000000000000,1,j1,0.1\n")
      .Decode("1500000000010000000,2,j1,0.3\n1500000000020000000,3,j2,0.5\n");
  EXPECT_THAT(made.decoder->columns().names, ElementsAre("%time", "field.header.seq", "j1_rad"));
  EXPECT_EQ(made.Values(), (Rows{{1.5e18, 1, 0.1}, {1.50000000001e18, 2, 0.3}}));
  EXPECT_EQ(made.decoder->counts().garbage, 1u);
}

TEST(TextFrames, AreJsonByNames) {
  Decoded made(FrameFormat::kDetect, ByteFlow::kPackets);
  made.Packet(R"({"seq":1,"t_s":0.5,"flex":[512,300],"name":"right"})")
      .Packet(R"({"seq":2,"t_s":0.51,"flex":[511,null],"name":"right"})")
      .Packet(R"({"flex":[510,299],"seq":3,"t_s":0.52,"battery":3.7})")
      .Packet(R"({"flex":[5)")
      .Packet(R"([1,2],[3,4])")
      .Packet(R"({"other":1})");
  EXPECT_EQ(made.decoder->format(), FrameFormat::kJson);
  EXPECT_THAT(made.decoder->columns().names, ElementsAre("seq", "t_s", "flex_1", "flex_2"));
  ASSERT_EQ(made.frames.size(), 3u);
  EXPECT_TRUE(std::isnan(made.frames[1].values[3]));
  EXPECT_EQ(made.frames[2].values, (std::vector{3.0, 0.52, 510.0, 299.0}));
  EXPECT_EQ(made.frames[2].number, 3);
  EXPECT_EQ(made.frames[2].sender_time_ns, 520'000'000);
  EXPECT_EQ(made.decoder->counts().half_frames, 1u);
  EXPECT_EQ(made.decoder->counts().garbage, 2u);
  EXPECT_EQ(Stream().Decode("[1,2]\n[3,4]\n").Values(), (Rows{{1, 2}, {3, 4}}));
}

TEST(TextFrames, AreJointStateOfRos2TopicEcho) {
  Decoded made = Stream();
  made.Decode(
      "1700000000,5,base,index,thumb,0.5,0.25\n1700000000,10000005,base,index,thumb,0.6,0.2\n");
  ASSERT_EQ(made.frames.size(), 2u);
  EXPECT_THAT(made.decoder->columns().names,
              ElementsAre("sec", "nanosec", "index_rad", "thumb_rad"));
  EXPECT_EQ(made.frames[1].sender_time_ns, 1'700'000'000'010'000'005) << "with all nanoseconds";
  EXPECT_EQ(made.frames[1].values[2], 0.6);
}

/// `t` may be in s, ms or us: only the clock of the arrivals shows it.
TEST(TextFrames, FindTheUnitOfATimeWithoutUnit) {
  for (const double scale_s : {1.0, 1e-3, 1e-6}) {
    Decoded made = Stream();
    made.step_ns = 10'000'000;
    made.Decode("t,flex\n");
    for (int i = 0; i < 100; ++i) {
      made.Decode(fmt::format("{},{}\n", 5.0 + 0.01 * i / scale_s, 500 + i));
    }
    ASSERT_EQ(made.frames.size(), 100u);
    EXPECT_FALSE(made.frames[10].sender_time_ns) << "a guess too early";
    ASSERT_TRUE(made.frames[99].sender_time_ns) << scale_s;
    EXPECT_NEAR(static_cast<double>(*made.frames[99].sender_time_ns), 1e9 * (5.0 * scale_s + 0.99),
                1e3);
  }
  Decoded file = Stream();  // not in real time
  file.Decode("t,flex\n");
  for (int i = 0; i < 1000; ++i) file.Decode(fmt::format("{},{}\n", 0.02 * i, i));
  EXPECT_FALSE(file.frames.back().sender_time_ns);
}

/// Two readings of half a second or more, and of five seconds at most, whose ratio is within 1.25.
TEST(SenderClock, NeedsTwoTimesThatAreNeitherNearNorFar) {
  struct Case {
    double arrival_s;
    double sent_s;
    bool is_found;
  };
  for (const Case& is : {Case{0.49, 0.49, false},
                         {0.5, 0.5, true},
                         {5.0, 5.0, true},
                         {5.01, 5.01, false},
                         {1.0, 1.24, true},
                         {1.0, 1.26, false},
                         {1.0, 0.81, true},
                         {1.0, 0.79, false},
                         {1.0, -1.0, false}}) {
    for (const double scale_s : {1.0, 1e-3, 1e-6, 1e-9}) {
      SenderClock clock;
      EXPECT_FALSE(clock.Add(7.0 / scale_s, 1'000'000'000));
      EXPECT_FALSE(clock.Add(NAN, 1'500'000'000));
      const auto found =
          clock.Add((7.0 + is.sent_s) / scale_s, 1'000'000'000 + std::llround(1e9 * is.arrival_s));
      EXPECT_EQ(found.has_value(), is.is_found) << is.arrival_s << " " << is.sent_s;
      EXPECT_EQ(found.value_or(scale_s), scale_s);
    }
  }
}

TEST(TextFrames, KeepNothingOfALineWithoutEnd) {
  Decoded made = Stream();
  made.Decode("1,2\n3,4\n");
  for (int i = 0; i < 100; ++i) made.Decode(std::string(4096, '7'));
  made.Decode("\n5,6\n");
  EXPECT_EQ(made.Values(), (Rows{{1, 2}, {3, 4}, {5, 6}}));
  EXPECT_EQ(made.decoder->counts().garbage, 1u);
}

TEST(TextFrames, AreAtMost65536BytesLong) {
  Decoded made = Stream();
  made.Decode("1,2\n3,4\n");
  for (const std::size_t size : {65536u, 65537u}) {
    made.Decode("5,6" + std::string(size - 3, ' ') + "\n7,8\n");
  }
  EXPECT_EQ(made.Values(), (Rows{{1, 2}, {3, 4}, {5, 6}, {7, 8}, {7, 8}}));
  EXPECT_EQ(made.decoder->problem(), "a line is longer than 65536 bytes");
}

TEST(TextFrames, HaveAHeadOfUpTo40Lines) {
  for (const int lines : {40, 41}) {
    Decoded made = Stream();
    for (int i = 0; i < lines; ++i) made.Decode("boot " + std::string(i + 1, 'x') + "\n");
    EXPECT_EQ(made.decoder->counts().garbage, lines == 41 ? 1u : 0u);
    made.Decode("1,2\n3,4\n");
    EXPECT_EQ(made.Values(), (Rows{{1, 2}, {3, 4}}));
    EXPECT_EQ(made.decoder->counts().garbage, static_cast<std::uint64_t>(lines));
  }
}

TEST(TextFrames, OfAChosenFormatAreNotOfAnother) {
  EXPECT_THAT(Stream(FrameFormat::kLabels).Decode("1,2\n3,4\n5,6\n7,8\n").Values(), IsEmpty());
  EXPECT_THAT(Stream(FrameFormat::kCsv).Decode("[1,2]\n[3,4]\n[5,6]\n").Values(), IsEmpty());
}

TEST(TextFrames, HaveNoInfiniteValue) {
  Decoded made = Stream();
  made.Decode("1,2\n3,inf\n4,1e999\n");
  ASSERT_EQ(made.frames.size(), 3u);
  EXPECT_TRUE(std::isnan(made.frames[1].values[1]));
  EXPECT_TRUE(std::isnan(made.frames[2].values[1]));
}

}  // namespace
}  // namespace gauntlet::sim
