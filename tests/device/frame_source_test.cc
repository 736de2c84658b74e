#include "sim/live/device/frame_source.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cmath>
#include <fstream>
#include <functional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "sim/base/error.h"
#include "sim/live/device/binary_frames.h"
#include "sim/live/device/byte_device.h"
#include "sim/live/device/device_clock.h"
#include "tests/device/decoder_support.h"
#include "tests/device/free_port.h"
#include "tests/device/pseudo_terminal.h"
#include "tests/support/program.h"

namespace gauntlet::sim {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::HasSubstr;
using State = FrameSource::State;

constexpr milliseconds kLongest(5000);

std::unique_ptr<FrameSource> Open(const std::string& address) {
  return OpenFrameSource(ParseDeviceAddress(address, DeviceRole::kSource));
}

/// Waits until there are so many frames, or a state is reached.
std::vector<KeptFrame> Receive(FrameSource& source, std::size_t count,
                               State until = State::kEnded) {
  std::vector<KeptFrame> frames;
  const auto end = std::chrono::steady_clock::now() + kLongest;
  while (frames.size() < count && std::chrono::steady_clock::now() < end) {
    if (source.Wait(milliseconds(50), Into(frames)) == until) break;
  }
  return frames;
}

/// A socket that sends to a port of this machine.
class Sender {
 public:
  explicit Sender(int port) : socket_(::socket(AF_INET, SOCK_DGRAM, 0)) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(static_cast<std::uint16_t>(port));
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    connect(socket_, reinterpret_cast<const sockaddr*>(&to), sizeof to);
  }
  ~Sender() { close(socket_); }
  Sender(const Sender&) = delete;
  Sender& operator=(const Sender&) = delete;

  void Send(std::string_view bytes) const { send(socket_, bytes.data(), bytes.size(), 0); }

 private:
  int socket_;
};

std::string ProblemOf(const std::function<void()>& call) {
  try {
    call();
  } catch (const UserError& error) {
    return error.what();
  }
  return "no error";
}

// --- UDP -----------------------------------------------------------------------------------------

/// Each format, as a program in another language makes it from its description.
TEST(UdpSource, ReceivesTheFramesOfAnotherProgram) {
  for (const std::string form : {"csv", "labels", "json", "binary", "osc", "bundle"}) {
    const int port = FreePort();
    const auto source = Open(fmt::format("udp:127.0.0.1:{}", port));
    std::thread sender([&] {
      const auto result =
          test::RunProgram({GAUNTLET_PYTHON, GAUNTLET_SEND_FRAMES, form, std::to_string(port)});
      EXPECT_EQ(result.exit_code, 0) << result.standard_error;
    });
    const std::vector<KeptFrame> frames = Receive(*source, 10);
    sender.join();
    ASSERT_EQ(frames.size(), 10u) << form;
    const SourceCounts counts = source->counts();
    EXPECT_EQ(counts.frames, 10u) << form;
    EXPECT_GT(counts.bytes, 100u) << form;
    EXPECT_EQ(counts.garbage + counts.half_frames + counts.foreign, 0u) << form;
    EXPECT_EQ(counts.overflowed + counts.reopened, 0u) << form;
    const std::vector<std::string>& names = source->columns().names;
    ASSERT_GE(names.size(), 2u) << form;
    if (form == "osc" || form == "bundle") {
      EXPECT_THAT(names, ElementsAre("right_1", "right_2"));
    } else {
      EXPECT_EQ(names[names.size() - 2], "index") << form;
      EXPECT_EQ(names.back(), "thumb_x") << form;
    }
    const bool has_number = form == "csv" || form == "json" || form == "binary";
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const auto number = static_cast<std::int64_t>(i);
      const std::vector<double>& values = frames[i].values;
      EXPECT_EQ(values[values.size() - 2], 512.0 + static_cast<double>(i)) << form;
      EXPECT_EQ(values.back(), 300.5 - static_cast<double>(i)) << form;
      if (has_number) {
        EXPECT_EQ(frames[i].number, number) << form;
      } else {
        EXPECT_FALSE(frames[i].number) << form;
      }
      if (has_number || form == "bundle") {
        ASSERT_TRUE(frames[i].sender_time_ns) << form;
        EXPECT_NEAR(static_cast<double>(*frames[i].sender_time_ns), 2e9 + 1e7 * i, 2.0) << form;
      }
      EXPECT_GT(frames[i].arrival_ns, i == 0 ? 0 : frames[i - 1].arrival_ns) << form;
    }
  }
}

/// The time is that of the arrival, not of the call that took the packet.
/// A kernel begins to note times a while after the first socket asked, so several packets are sent.
TEST(UdpSource, HasTheTimeOfArrival) {
  const int port = FreePort();
  const auto source = Open(fmt::format("udp:127.0.0.1:{}", port));
  const Sender sender(port);
  sender.Send("a,b");
  constexpr std::int64_t kMargin_ns = 1'000'000;  // between reading two clocks
  bool noted = false;
  for (int attempt = 0; attempt < 50 && !noted; ++attempt) {
    const std::int64_t before_ns = MonotonicNow_ns();
    sender.Send("3,4");
    const std::int64_t after_ns = MonotonicNow_ns();
    std::this_thread::sleep_for(milliseconds(100));
    const std::vector<KeptFrame> frames = Receive(*source, 1);
    ASSERT_EQ(frames.size(), 1u);
    noted = frames[0].arrival_ns > before_ns - kMargin_ns &&
            frames[0].arrival_ns < after_ns + kMargin_ns;
  }
  EXPECT_TRUE(noted) << "no packet has the time at which it came";
}

/// What a network does to packets: the source passes on what came, in the order of arrival.
TEST(UdpSource, PassesOnRepeatedAndReorderedFramesAndCountsTheRest) {
  const int port = FreePort();
  const auto source = Open(fmt::format("udp:127.0.0.1:{}", port));
  const Sender sender(port);
  for (const char* packet :
       {"k,a,b", "1,10,20", "2,11,21", "2,11,21", "5,14,24", "4,13,23", "\xff\xfe garbage \n",
        "6,15", "7,16,26,36", "8,17,27\n9,18,28\n", ""}) {
    sender.Send(packet);
  }
  const std::vector<KeptFrame> frames = Receive(*source, 7);
  std::vector<std::int64_t> numbers;
  for (const KeptFrame& frame : frames) numbers.push_back(frame.number.value_or(-1));
  EXPECT_THAT(numbers, ElementsAre(1, 2, 2, 5, 4, 8, 9));
  EXPECT_EQ(source->counts().half_frames, 1u + 1u) << "6,15 and, of one value, the garbage";
  EXPECT_EQ(source->counts().garbage, 1u);
  EXPECT_EQ(source->counts().frames, 7u);
  EXPECT_EQ(source->counts().bytes, 82u);
  EXPECT_EQ(source->Description(), fmt::format("udp:127.0.0.1:{}, csv", port));
}

/// A message to a group that does not leave this machine.
class Group {
 public:
  explicit Group(const std::string& host)
      : socket_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)),
        address_(fmt::format("udp:{}:{}", host, FreePort())) {
    const int hops = 0;
    setsockopt(socket_, IPPROTO_IP, IP_MULTICAST_TTL, &hops, sizeof hops);
    to_.sin_family = AF_INET;
    to_.sin_addr.s_addr = inet_addr(host.c_str());
    to_.sin_port =
        htons(static_cast<std::uint16_t>(ParseDeviceAddress(address_, DeviceRole::kSource).port));
  }
  ~Group() { close(socket_); }
  Group(const Group&) = delete;
  Group& operator=(const Group&) = delete;

  const std::string& address() const { return address_; }
  void Send(std::string_view text) const {
    sendto(socket_, text.data(), text.size(), 0, reinterpret_cast<const sockaddr*>(&to_),
           sizeof to_);
  }
  /// True if a member that asks the system itself gets what is sent.
  bool HasWay() const {
    const int member = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    ip_mreqn wanted{};
    wanted.imr_multiaddr = to_.sin_addr;
    setsockopt(member, IPPROTO_IP, IP_ADD_MEMBERSHIP, &wanted, sizeof wanted);
    bind(member, reinterpret_cast<const sockaddr*>(&to_), sizeof to_);
    Send("x");
    const bool has_way = WaitReadable(member, milliseconds(500));
    close(member);
    return has_way;
  }

 private:
  int socket_;
  std::string address_;
  sockaddr_in to_{};
};

TEST(UdpSource, JoinsTheGroupOfAMulticastAddress) {
  // Another group: a member lets packets in for all who listen to its own.
  if (!Group("239.77.1.10").HasWay()) GTEST_SKIP() << "this machine has no way for groups";
  const Group group("239.77.1.9");
  const auto first = Open(group.address());
  const auto second = Open(group.address());
  group.Send("a,b\n");
  group.Send("1,2\n");
  EXPECT_EQ(Receive(*first, 1).size(), 1u);
  EXPECT_EQ(Receive(*second, 1).size(), 1u);
}

TEST(UdpSource, SaysWhyAPortIsNotOpened) {
  const int port = FreePort();
  const std::string address = fmt::format("udp:127.0.0.1:{}", port);
  const auto source = Open(address);
  EXPECT_THAT(ProblemOf([&] { Open(address); }),
              HasSubstr(fmt::format("another program listens on port {}", port)));
  EXPECT_THAT(ProblemOf([&] { Open(fmt::format("udp:192.0.2.1:{}", port)); }),
              HasSubstr("is no address of this machine: 127.0.0.1 takes"));
  EXPECT_THAT(ProblemOf([&] { Open("udp:no.host.invalid:9000"); }),
              HasSubstr("the host no.host.invalid is not found"));
  EXPECT_THAT(ProblemOf([] { Open("udp:[fe80::1]:9000"); }),
              testing::Not(HasSubstr("reserved")));  // of no link
  source->Wait(milliseconds(1), [](const DeviceFrame&) {});
  EXPECT_THAT(source->AdviceWithoutFrames(), HasSubstr("nothing arrives"));
  Sender(port).Send("hello");
  source->Wait(kLongest, [](const DeviceFrame&) {});
  EXPECT_THAT(source->AdviceWithoutFrames(), HasSubstr("5 bytes arrived, and none is a frame"));
}

TEST(UdpSource, AdvisesWhatToTryWithoutFrames) {
  const int port = FreePort();
  const std::string address = fmt::format("udp:127.0.0.1:{}", port);
  const auto source = Open(address);
  EXPECT_EQ(source->AdviceWithoutFrames(),
            fmt::format("nothing arrives: does the sender send to this machine, port {}, and does "
                        "a firewall let it in? 0.0.0.0 as host takes packets from other machines",
                        port));
  const Sender sender(port);
  for (const char* packet : {"hello, hello", "; is there nobody?"}) {
    sender.Send(packet);
    source->Wait(kLongest, [](const DeviceFrame&) {});
  }
  EXPECT_EQ(source->AdviceWithoutFrames(),
            fmt::format("30 bytes arrived, and none is a frame; they begin with 'hello, hello; is "
                        "there n'; try a format behind a comma, as {},csv",
                        address));
}

// --- Serial lines --------------------------------------------------------------------------------

class SerialSource : public testing::Test {
 protected:
  test::TemporaryDirectory folder_;
  PseudoTerminal glove_{folder_.path() / "glove"};
  std::string address_ = fmt::format("serial:{}@115200", glove_.link().string());
};

TEST_F(SerialSource, LeavesOutBootMessagesAndWhatWasCut) {
  glove_.Write("old,old\n1,1\n2,2\n");  // before the program began: no sample of now
  const auto source = Open(address_);
  glove_.Write(",7\nets Jun  8 2016\n512,300\n511,301\n5");
  glove_.Write("10,302\n\x80\xff,3\n509,303\n");
  std::vector<Rows::value_type> values;
  for (const KeptFrame& frame : Receive(*source, 4)) values.push_back(frame.values);
  EXPECT_EQ(values, (Rows{{512, 300}, {511, 301}, {510, 302}, {509, 303}}));
  EXPECT_EQ(source->counts().garbage, 2u);
  EXPECT_EQ(source->counts().bytes, 56u) << "without those from before";
  EXPECT_THAT(source->Description(), HasSubstr(", csv, low latency is not available"));
}

TEST_F(SerialSource, SurvivesADeviceThatVanishesAndComesBack) {
  const auto source = Open(address_);
  for (int times = 1; times <= 3; ++times) {
    glove_.Write(fmt::format("\n{},1\n{},2\n{},", times, times, times));
    const std::vector<KeptFrame> frames = Receive(*source, 2);
    ASSERT_EQ(frames.size(), 2u);
    EXPECT_EQ(frames[1].values, (std::vector{1.0 * times, 2.0}));
    source->Wait(milliseconds(20), [](const DeviceFrame&) { FAIL() << "a frame of parts"; });
    glove_.Unplug();
    EXPECT_TRUE(Receive(*source, 1, State::kGone).empty());
    const auto gone = std::chrono::steady_clock::now();
    EXPECT_EQ(source->Wait(milliseconds(50), [](const DeviceFrame&) {}), State::kGone);
    EXPECT_GE(std::chrono::steady_clock::now() - gone, milliseconds(50))
        << "it waits for all of it";
    EXPECT_EQ(source->Wait(milliseconds(1), [](const DeviceFrame&) {}), State::kGone);
    EXPECT_FALSE(source->problem().empty());
    glove_.Plug();
    const auto end = std::chrono::steady_clock::now() + kLongest;
    while (source->counts().reopened < static_cast<std::uint64_t>(times) &&
           std::chrono::steady_clock::now() < end) {
      source->Wait(milliseconds(20), [](const DeviceFrame&) { FAIL() << "an old frame"; });
    }
    ASSERT_EQ(source->counts().reopened, static_cast<std::uint64_t>(times));
  }
}

TEST_F(SerialSource, AsksACybergloveForEachFrame) {
  const auto source = Open(address_ + ",cyberglove");
  std::vector<KeptFrame> frames;
  for (int i = 1; i < 40 && frames.size() < 10; ++i) {
    source->Wait(milliseconds(1), Into(frames));
    if (glove_.Read(20) != "G") continue;
    std::string answer = "G" + std::string(22, static_cast<char>(i)) + std::string(1, '\0');
    glove_.Write(answer.substr(0, 9));
    source->Wait(milliseconds(20), Into(frames));
    glove_.Write(answer.substr(9));
    source->Wait(milliseconds(20), Into(frames));
  }
  ASSERT_EQ(frames.size(), 10u);
  EXPECT_EQ(frames[0].values, std::vector<double>(22, frames[0].values[0]));
  EXPECT_EQ(frames[9].values[0], frames[0].values[0] + 9.0) << "each is new";
}

TEST_F(SerialSource, SaysWhyItIsNotOpened) {
  EXPECT_THAT(ProblemOf([] { Open("serial:/dev/ttyUSB999"); }),
              HasSubstr("serial:/dev/ttyUSB999: no such device: "));
  EXPECT_THAT(ProblemOf([] { Open("serial:/dev/null"); }), HasSubstr("is no serial device"));
  EXPECT_THAT(ProblemOf([] { Open("serial:/etc/passwd"); }),
              HasSubstr("is no serial device; a recording is file:PATH"));
  const std::string odd = fmt::format("serial:{}@115201", glove_.link().string());
  EXPECT_THAT(
      ProblemOf([&] { Open(odd); }),
      HasSubstr("115201 baud is no rate of serial lines: 9600, 19200, 38400, 57600, 115200, "
                "230400, 460800, 576000, 921600, "));
  const auto source = Open(address_);
  EXPECT_THAT(ProblemOf([&] { Open(address_); }), HasSubstr("another program uses it (fuser "));
}

TEST_F(SerialSource, AdvisesAnotherBaudRateForBytesThatAreNoFrames) {
  const auto source = Open(address_);
  glove_.Write("\xf8\x80\x00\xfe\x1c\x9e");
  source->Wait(kLongest, [](const DeviceFrame&) { FAIL() << "noise as a frame"; });
  EXPECT_THAT(source->AdviceWithoutFrames(), HasSubstr("try another baud rate behind @"));
}

TEST_F(SerialSource, TakesEachRateOfSerialLines) {
  const int far = open(glove_.link().c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  for (const auto& [baud, speed] : std::vector<std::pair<int, speed_t>>{
           {300, B300},         {600, B600},         {1200, B1200},       {1800, B1800},
           {2400, B2400},       {4800, B4800},       {9600, B9600},       {19200, B19200},
           {38400, B38400},     {57600, B57600},     {115200, B115200},   {230400, B230400},
           {460800, B460800},   {500000, B500000},   {576000, B576000},   {921600, B921600},
           {1000000, B1000000}, {1152000, B1152000}, {1500000, B1500000}, {2000000, B2000000},
           {2500000, B2500000}, {3000000, B3000000}, {3500000, B3500000}, {4000000, B4000000}}) {
    const auto source = Open(fmt::format("serial:{}@{}", glove_.link().string(), baud));
    termios line{};
    ASSERT_EQ(tcgetattr(far, &line), 0);
    EXPECT_EQ(cfgetispeed(&line), speed) << baud;
    EXPECT_EQ(cfgetospeed(&line), speed) << baud;
    EXPECT_EQ(line.c_lflag & (ICANON | ECHO), 0u) << "raw";
    EXPECT_EQ(line.c_cflag & (CSIZE | PARENB | CSTOPB | CLOCAL | CREAD),
              static_cast<tcflag_t>(CS8 | CLOCAL | CREAD))
        << "8 data bits, no parity, 1 stop bit";
  }
  close(far);
}

// --- Files and standard input --------------------------------------------------------------------

TEST(FileSource, PlaysRowsAtTheirTimes) {
  const test::TemporaryDirectory folder;
  const std::filesystem::path file = folder.path() / "glove.csv";
  std::ofstream(file) << "t_ms,index,label\n100,5,rest\n120,6,rest\n125,7,fast\n125,8,fast\n";
  const auto source = Open("file:" + file.string());
  const std::vector<KeptFrame> frames = Receive(*source, 5);
  ASSERT_EQ(frames.size(), 4u) << "and then it has ended";
  EXPECT_EQ(frames[1].arrival_ns - frames[0].arrival_ns, 20'000'000);
  EXPECT_EQ(frames[2].arrival_ns - frames[1].arrival_ns, 5'000'000);
  EXPECT_EQ(frames[3].arrival_ns, frames[2].arrival_ns);
  EXPECT_LE(frames[3].arrival_ns, MonotonicNow_ns());
  EXPECT_EQ(frames[2].values[1], 7.0);
  EXPECT_EQ(frames[2].sender_time_ns, 125'000'000);
  EXPECT_EQ(source->columns().names[1], "index");
  EXPECT_EQ(source->Wait(milliseconds(0), [](const DeviceFrame&) {}), State::kEnded);
}

// Wrong: it looks again and again until a row is due.
TEST(FileSource, SleepsUntilARowIsDueOrTheTimeIsOver) {
  const test::TemporaryDirectory folder;
  const std::filesystem::path file = folder.path() / "glove.csv";
  std::ofstream(file) << "time_s,index\n0,5\n0.1,6\n0.2,7\n";
  const auto source = Open("file:" + file.string());
  std::vector<KeptFrame> frames;
  source->Wait(kLongest, Into(frames));
  EXPECT_EQ(frames.size(), 1u);
  const std::int64_t begin_ns = MonotonicNow_ns();
  EXPECT_EQ(source->Wait(milliseconds(1), Into(frames)), State::kOpen);
  EXPECT_GE(MonotonicNow_ns() - begin_ns, 1'000'000);
  for (std::size_t i = 2; i <= 3 && frames.size() < 3; ++i) {
    source->Wait(kLongest, Into(frames));
    EXPECT_GE(frames.size(), i);
    EXPECT_GE(MonotonicNow_ns(), frames.back().arrival_ns);
  }
}

/// A time that is missing, stands still, goes back or jumps by ten seconds is due with the row
/// before it, and the times behind it count from there.
TEST(FileSource, PassesOverTimesThatAreNone) {
  const test::TemporaryDirectory folder;
  const std::filesystem::path file = folder.path() / "glove.csv";
  std::ofstream(file) << "time_s,index\n5.00,1\n5.01,2\n,3\n5.02,4\n5.02,5\n4.00,6\n4.01,7\n"
                         "14.01,8\n14.02,9\n";
  const auto source = Open("file:" + file.string());
  const std::vector<KeptFrame> frames = Receive(*source, 10);
  std::vector<double> due_ms;
  for (const KeptFrame& frame : frames) {
    due_ms.push_back(1e-6 * static_cast<double>(frame.arrival_ns - frames[0].arrival_ns));
  }
  EXPECT_THAT(due_ms, testing::Pointwise(testing::DoubleNear(1e-3),
                                         {0.0, 10.0, 10.0, 20.0, 20.0, 20.0, 30.0, 30.0, 40.0}));
  EXPECT_EQ(source->counts().frames, 9u);
}

TEST(FileSource, GivesAThousandRowsAtOnceWithoutTheirTimes) {
  const test::TemporaryDirectory folder;
  const std::filesystem::path file = folder.path() / "glove.csv";
  std::ofstream text(file);
  text << "index,thumb\n";
  for (int row = 0; row < 2500; ++row) text << row << ",1\n";
  text.close();
  const auto source = OpenFrameSource(
      ParseDeviceAddress("file:" + file.string(), DeviceRole::kSource), {.is_paced = false});
  std::vector<KeptFrame> frames;
  EXPECT_EQ(source->Wait(milliseconds(0), Into(frames)), State::kOpen);
  EXPECT_EQ(frames.size(), 1000u);
  EXPECT_EQ(source->Wait(milliseconds(0), Into(frames)), State::kOpen);
  EXPECT_EQ(source->Wait(milliseconds(0), Into(frames)), State::kEnded);
  EXPECT_EQ(frames.size(), 2500u);
  EXPECT_EQ(source->Wait(milliseconds(0), Into(frames)), State::kEnded);
}

TEST(FileSource, NeedsARateWithoutTimes) {
  const test::TemporaryDirectory folder;
  const std::filesystem::path file = folder.path() / "glove.csv";
  std::ofstream(file) << "index,thumb\n5,1\n6,2\n7,1\n";
  const DeviceAddress address = ParseDeviceAddress("file:" + file.string(), DeviceRole::kSource);
  EXPECT_THAT(ProblemOf([&] { OpenFrameSource(address); }), HasSubstr("has no column of time"));
  const auto source = OpenFrameSource(address, {.file_rate_hz = 200.0});
  const std::vector<KeptFrame> frames = Receive(*source, 3);
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_EQ(frames[2].arrival_ns - frames[0].arrival_ns, 10'000'000);
}

TEST(StandardInputSource, EndsWithItsPipe) {
  std::array<int, 2> pipe{};
  ASSERT_EQ(::pipe(pipe.data()), 0);
  const int before = dup(STDIN_FILENO);
  dup2(pipe[0], STDIN_FILENO);
  const auto source = Open("stdin");
  const std::string text = "a,b\n1,2\n3,4\n5,";
  ASSERT_EQ(write(pipe[1], text.data(), text.size()), std::ssize(text));
  std::vector<KeptFrame> frames;
  EXPECT_EQ(source->Wait(kLongest, Into(frames)), State::kOpen);
  close(pipe[1]);
  EXPECT_EQ(source->Wait(kLongest, Into(frames)), State::kEnded);
  EXPECT_EQ(frames.size(), 2u);
  EXPECT_EQ(source->counts().half_frames, 1u);
  EXPECT_EQ(source->counts().bytes, text.size());
  EXPECT_EQ(source->problem(), "the last line has no end");
  EXPECT_EQ(source->Description(), "stdin, csv");
  dup2(before, STDIN_FILENO);
  close(before);
  close(pipe[0]);
}

// Wrong: it waits for ever.
TEST(StandardInputSource, EndsWhereItCannotBeRead) {
  const int before = dup(STDIN_FILENO);
  const int folder = open("/", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  dup2(folder, STDIN_FILENO);
  const auto source = Open("stdin");
  EXPECT_EQ(source->Wait(kLongest, [](const DeviceFrame&) {}), State::kEnded);
  EXPECT_EQ(source->problem(), "Is a directory");
  EXPECT_EQ(source->AdviceWithoutFrames(),
            "nothing arrives: does the program on the left of the pipe write at once (stdbuf "
            "-oL)?");
  dup2(before, STDIN_FILENO);
  close(before);
  close(folder);
}

}  // namespace
}  // namespace gauntlet::sim
