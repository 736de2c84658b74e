// The examples of docs/reference/live-formats.md are what the page says.
#include <gmock/gmock.h>

#include <sstream>
#include <string>

#include "sim/base/csv_line.h"
#include "sim/live/device/binary_frames.h"
#include "tests/device/decoder_support.h"
#include "tests/support/read_file.h"
#include "tests/support/source_dir.h"

namespace gauntlet::sim {
namespace {

using testing::ElementsAre;

/// The block of text below the heading of a format.
std::string ExampleOf(const std::string& format) {
  const std::string page = test::ReadFile(SourceDir() + "/docs/reference/live-formats.md");
  const std::string fence = "```text\n";
  const std::size_t begin = page.find(fence, page.find("\n## " + format + "\n")) + fence.size();
  return page.substr(begin, page.find("```", begin) - begin);
}

std::string BytesOf(const std::string& hexadecimal) {
  std::istringstream words(hexadecimal);
  std::string bytes;
  for (std::string word; words >> word;) {
    bytes.push_back(static_cast<char>(std::stoi(word, nullptr, 16)));
  }
  return bytes;
}

/// With a line end in front: a serial line that was opened within a frame.
Decoded FromSerialLine(const std::string& bytes, FrameFormat format = FrameFormat::kDetect) {
  Decoded made(format, ByteFlow::kCutStream);
  made.Decode("\n").Decode(bytes);
  return made;
}

TEST(LiveFormats, ExamplesOfTextAreRead) {
  for (const auto format :
       {FrameFormat::kCsv, FrameFormat::kLabels, FrameFormat::kAlpha, FrameFormat::kJson}) {
    const std::string text = ExampleOf(std::string(WordOf(format)));
    const Decoded made = FromSerialLine(text);
    const std::size_t names = format == FrameFormat::kCsv ? 1 : 0;
    EXPECT_EQ(made.frames.size(), SplitLines(text).size() - names) << text;
    ASSERT_GE(made.frames.size(), 2u);
    EXPECT_EQ(made.decoder->format(), format);
    EXPECT_EQ(made.decoder->counts().garbage, 0u);
    const std::vector<double>& values = made.frames[0].values;
    EXPECT_THAT(values, testing::Contains(512.0));
    EXPECT_THAT(values, testing::Contains(format == FrameFormat::kAlpha ? 300.0 : 300.5));
    if (format == FrameFormat::kCsv || format == FrameFormat::kJson) {
      EXPECT_EQ(made.frames[1].number, 8);
      EXPECT_EQ(made.frames[1].sender_time_ns, 2'010'000'000);
    }
  }
  EXPECT_THAT(FromSerialLine(ExampleOf("json")).decoder->columns().names,
              ElementsAre("frame", "time_s", "flex_1", "flex_2"));
}

TEST(LiveFormats, ExampleOfBinaryIsReadAndWritten) {
  const std::string bytes = BytesOf(ExampleOf("binary"));
  const std::vector<double> values = {512.0, 300.5};
  EXPECT_EQ(bytes, BinaryNames({"index", "thumb"}) +
                       BinaryFrame({.number = 7, .time_ns = 2'000'000'000, .values = values}));
  const Decoded made = FromSerialLine(bytes);
  EXPECT_EQ(made.Values(), (Rows{values}));
  EXPECT_THAT(made.decoder->columns().names, ElementsAre("index", "thumb"));
}

TEST(LiveFormats, ExampleOfOscIsRead) {
  Decoded made(FrameFormat::kDetect, ByteFlow::kPackets);
  made.step_ns = 100'000'000;
  for (int i = 0; i < 3; ++i) made.Packet(BytesOf(ExampleOf("osc")));
  EXPECT_EQ(made.Values(), (Rows{{1, 0.5}, {1, 0.5}, {1, 0.5}}));
}

TEST(LiveFormats, ExampleOfCybergloveIsRead) {
  const std::string frame = BytesOf(ExampleOf("cyberglove"));
  Decoded made(FrameFormat::kCyberglove, ByteFlow::kCutStream);
  made.Decode(frame).Decode(frame);
  ASSERT_EQ(made.frames.size(), 1u);
  EXPECT_EQ(made.frames[0].values.size(), 18u);
  EXPECT_EQ(made.frames[0].values[17], 145.0);
}

}  // namespace
}  // namespace gauntlet::sim
