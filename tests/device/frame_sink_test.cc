#include "sim/live/device/frame_sink.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "sim/base/csv_line.h"
#include "sim/base/error.h"
#include "sim/live/device/frame_source.h"
#include "sim/tables/missing.h"
#include "tests/device/decoder_support.h"
#include "tests/device/free_port.h"
#include "tests/device/pseudo_terminal.h"
#include "tests/support/program.h"

namespace gauntlet::sim {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::HasSubstr;
using Result = FrameSink::Result;

std::unique_ptr<FrameSink> Open(const std::string& address, std::vector<std::string> names) {
  return OpenFrameSink(ParseDeviceAddress(address, DeviceRole::kSink), names);
}

Result SendNumber(FrameSink& sink, std::int64_t number) {
  const std::vector<double> values = {512.0 + static_cast<double>(number), kMissing};
  return sink.Send({.number = number, .time_ns = 1'000'000'007 + number, .values = values});
}

TEST(FrameSink, OverUdpSendsWhatASourceReads) {
  for (const std::string format : {"csv", "labels", "json", "binary", "osc", "osc/"}) {
    const bool is_osc = format.starts_with("osc");
    const int port = FreePort();
    const auto source = OpenFrameSource(
        ParseDeviceAddress(is_osc ? fmt::format("osc:{}/hand{}", port, format == "osc" ? "" : "/*")
                                  : fmt::format("udp:127.0.0.1:{}", port),
                           DeviceRole::kSource));
    const auto sink = Open(is_osc ? fmt::format("osc:127.0.0.1:{}/hand{}", port, format.substr(3))
                                  : fmt::format("udp:127.0.0.1:{},{}", port, format),
                           {"index", "thumb"});
    std::vector<KeptFrame> frames;
    for (int i = 0; i < 30; ++i) {
      EXPECT_EQ(SendNumber(*sink, i), Result::kSent) << format;
      source->Wait(milliseconds(10), Into(frames));
    }
    ASSERT_EQ(frames.size(), 30u) << format;
    EXPECT_EQ(sink->counts().frames, 30u);
    const std::vector<std::string>& names = source->columns().names;
    const std::size_t first = names.size() - 2;
    EXPECT_EQ(names[first], format == "osc" ? "hand_1" : "index") << format;
    for (int i = 0; i < 30; ++i) {
      EXPECT_EQ(frames[i].values[first], 512.0 + i) << format;
      EXPECT_TRUE(std::isnan(frames[i].values[first + 1])) << format;
      if (format == "csv" || format == "json" || format == "binary") {
        EXPECT_EQ(frames[i].number, i) << format;
        EXPECT_NEAR(static_cast<double>(frames[i].sender_time_ns.value_or(0)), 1'000'000'007.0 + i,
                    format == "json" ? 1.0 : 0.0)
            << format;
      }
    }
  }
}

/// The bytes of each format, as docs/reference/live-formats.md has them.
TEST(FrameSink, SendsTheNamesWithTheFirstFrameAndEachSecond) {
  const std::vector<std::pair<std::string, std::vector<std::string>>> packets = {
      {"csv",
       {"frame,time_s,a,b\n", "7,1.000000014,519,\n", "8,1.000000015,520,\n", "frame,time_s,a,b\n",
        "9,1.000000016,521,\n"}},
      {"labels", {"a:519 b:nan\n", "a:520 b:nan\n", "a:521 b:nan\n"}},
      {"json",
       {R"({"frame":7,"time_s":1.000000014,"a":519.0,"b":null})"
        "\n",
        R"({"frame":8,"time_s":1.000000015,"a":520.0,"b":null})"
        "\n",
        R"({"frame":9,"time_s":1.000000016,"a":521.0,"b":null})"
        "\n"}}};
  for (const auto& [format, expected] : packets) {
    const int socket = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof at;
    ASSERT_EQ(bind(socket, reinterpret_cast<const sockaddr*>(&at), size), 0);
    getsockname(socket, reinterpret_cast<sockaddr*>(&at), &size);
    const std::string address = fmt::format("udp:127.0.0.1:{},{}", ntohs(at.sin_port), format);
    const auto sink = Open(address, {"a", "b"});
    SendNumber(*sink, 7);
    SendNumber(*sink, 8);
    usleep(1'010'000);
    SendNumber(*sink, 9);
    std::vector<std::string> got;
    std::array<char, 256> packet;
    ssize_t bytes = 0;
    while ((bytes = recv(socket, packet.data(), packet.size(), MSG_DONTWAIT)) >= 0) {
      got.emplace_back(packet.data(), static_cast<std::size_t>(bytes));
    }
    EXPECT_EQ(got, expected) << format;
    EXPECT_EQ(sink->counts().frames, 3u);
    EXPECT_EQ(sink->counts().bytes, 3 * expected[1].size());
    EXPECT_EQ(sink->counts().dropped + sink->counts().failed, 0u);
    EXPECT_EQ(sink->Description(), address);
    close(socket);
  }
}

/// The system tells a sender that nothing listens; the next frame goes out again.
TEST(FrameSink, OverUdpNoticesThatNothingListens) {
  const std::string at = fmt::format("udp:127.0.0.1:{}", FreePort());
  const auto sink = Open(at, {"a", "b"});
  bool is_gone = false;
  for (int i = 0; i < 100 && !is_gone; ++i) is_gone = SendNumber(*sink, i) == Result::kGone;
  EXPECT_TRUE(is_gone);
  EXPECT_THAT(sink->problem(), HasSubstr("refused"));
  const auto source = OpenFrameSource(ParseDeviceAddress(at, DeviceRole::kSource));
  std::vector<KeptFrame> frames;
  for (int i = 0; i < 5; ++i) SendNumber(*sink, i);
  source->Wait(milliseconds(100), Into(frames));
  EXPECT_FALSE(frames.empty());
}

TEST(FrameSink, ToNothingCounts) {
  const auto sink = Open("none", {"a", "b"});
  EXPECT_EQ(SendNumber(*sink, 1), Result::kSent);
  EXPECT_EQ(sink->counts().frames, 1u);
}

/// Standard output is a pipe while the test runs.
class PipeSink : public testing::Test {
 protected:
  PipeSink() {
    std::fflush(stdout);
    before_ = dup(STDOUT_FILENO);
    EXPECT_EQ(pipe(pipe_.data()), 0);
    dup2(pipe_[1], STDOUT_FILENO);
    close(pipe_[1]);
    std::signal(SIGPIPE, SIG_IGN);
  }
  ~PipeSink() override {
    Restore();
    close(before_);
    close(pipe_[0]);
  }
  /// Before messages of the test are printed.
  void Restore() const { dup2(before_, STDOUT_FILENO); }
  std::string Read() const {
    std::string got(1 << 20, '\0');
    const ssize_t size = read(pipe_[0], got.data(), got.size());
    got.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
    return got;
  }

  int before_ = -1;
  std::array<int, 2> pipe_{};
};

TEST_F(PipeSink, DropsWholeFramesWhenNobodyReads) {
  fcntl(pipe_[0], F_SETPIPE_SZ, 16384);
  const auto sink = Open("stdout", {"a", "b"});
  const auto begin = std::chrono::steady_clock::now();
  for (int i = 0; i < 1000; ++i) SendNumber(*sink, i);
  const auto took = std::chrono::steady_clock::now() - begin;
  std::string text = Read();
  const Result newest = SendNumber(*sink, 5000);
  text += Read();
  Restore();
  EXPECT_GT(sink->counts().dropped, 300u);
  EXPECT_EQ(newest, Result::kSent) << "the newest, not what was dropped";
  EXPECT_LT(took, std::chrono::seconds(2)) << "a sink never waits";
  EXPECT_TRUE(text.ends_with('\n'));
  const std::vector<std::string_view> lines = SplitLines(text);
  EXPECT_EQ(lines.front(), "frame,time_s,a,b");
  EXPECT_EQ(lines.back(), "5000,1.000005007,5512,");
  EXPECT_EQ(lines.size(), 1 + sink->counts().frames);
  for (const std::string_view line : lines) EXPECT_EQ(SplitCells(line).size(), 4u) << line;
}

TEST_F(PipeSink, NoticesThatTheReaderIsGone) {
  const auto sink = Open("stdout", {"a", "b"});
  const Result first = SendNumber(*sink, 1);
  close(pipe_[0]);
  const Result second = SendNumber(*sink, 2);
  const Result third = SendNumber(*sink, 3);
  Restore();
  EXPECT_EQ(first, Result::kSent);
  EXPECT_EQ(second, Result::kGone);
  EXPECT_EQ(third, Result::kGone);
  EXPECT_EQ(sink->counts().failed, 2u);
}

TEST(FrameSink, OverASerialLineComesBackWithTheDevice) {
  const test::TemporaryDirectory folder;
  PseudoTerminal hand(folder.path() / "hand");
  const auto sink = Open("serial:" + hand.link().string(), {"a", "b"});
  EXPECT_EQ(SendNumber(*sink, 1), Result::kSent);
  EXPECT_EQ(hand.Read(1000, 36), "frame,time_s,a,b\n1,1.000000008,513,\n");
  hand.Unplug();
  EXPECT_EQ(SendNumber(*sink, 2), Result::kGone);
  EXPECT_EQ(SendNumber(*sink, 3), Result::kGone);
  EXPECT_EQ(sink->counts().failed, 2u);
  EXPECT_EQ(sink->counts().bytes, 19u);
  // A device is looked for five times a second.
  usleep(250'000);
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_EQ(SendNumber(*sink, 3), Result::kGone);
  hand.Plug();
  Result result = Result::kGone;
  for (int i = 0; i < 100 && result != Result::kSent; ++i) {
    usleep(20'000);
    result = SendNumber(*sink, 4);
  }
  EXPECT_EQ(result, Result::kSent);
  EXPECT_GE(std::chrono::steady_clock::now() - begin, milliseconds(200));
  EXPECT_EQ(hand.Read(1000, 36), "frame,time_s,a,b\n4,1.000000011,516,\n");
}

TEST(FrameSink, OverASerialLineRepeatsTheNamesEachSecondToWhoTakesThemBetweenFrames) {
  const test::TemporaryDirectory folder;
  for (const bool repeats : {false, true}) {
    PseudoTerminal hand(folder.path() / "hand");
    const auto sink =
        OpenFrameSink(ParseDeviceAddress("serial:" + hand.link().string(), DeviceRole::kSink),
                      {"a", "b"}, repeats);
    EXPECT_EQ(SendNumber(*sink, 1), Result::kSent);
    EXPECT_EQ(hand.Read(1000, 36), "frame,time_s,a,b\n1,1.000000008,513,\n");
    usleep(1'050'000);
    EXPECT_EQ(SendNumber(*sink, 2), Result::kSent);
    EXPECT_EQ(SendNumber(*sink, 3), Result::kSent);
    EXPECT_EQ(hand.Read(1000, repeats ? 55 : 38), std::string(repeats ? "frame,time_s,a,b\n" : "") +
                                                      "2,1.000000009,514,\n3,1.000000010,515,\n");
  }
}

TEST(FrameSink, RefusesAFormatThatIsOnlyReceived) {
  try {
    Open("udp:127.0.0.1:9000,cyberglove", {"a"});
    FAIL();
  } catch (const UserError& error) {
    EXPECT_THAT(error.what(), HasSubstr("cyberglove is only received; csv, labels, json"));
  }
}

}  // namespace
}  // namespace gauntlet::sim
