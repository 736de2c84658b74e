#include "sim/live/device/serial_line.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <grp.h>
#include <linux/serial.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <utility>
#include <vector>

#include "sim/base/error.h"
#include "sim/base/text.h"
#include "sim/live/device/byte_device.h"
#include "sim/live/device/device_clock.h"

namespace gauntlet::sim {
namespace {

constexpr std::array<std::pair<int, speed_t>, 24> kSpeeds = {
    {{300, B300},         {600, B600},         {1200, B1200},       {2400, B2400},
     {4800, B4800},       {9600, B9600},       {19200, B19200},     {38400, B38400},
     {57600, B57600},     {115200, B115200},   {230400, B230400},   {460800, B460800},
     {500000, B500000},   {576000, B576000},   {921600, B921600},   {1000000, B1000000},
     {1152000, B1152000}, {1500000, B1500000}, {2000000, B2000000}, {2500000, B2500000},
     {3000000, B3000000}, {3500000, B3500000}, {4000000, B4000000}, {1800, B1800}}};

/// The serial devices of this machine, for messages.
std::string DevicesHere() {
  std::vector<std::string> found;
  std::error_code error;
  for (const char* folder : {"/dev/serial/by-id", "/dev"}) {
    for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
      const std::string name = entry.path().filename();
      const bool is_serial = std::string_view(folder) != "/dev" || name.starts_with("ttyUSB") ||
                             name.starts_with("ttyACM") || name.starts_with("rfcomm");
      if (is_serial && TextProblem(name).empty()) found.push_back(entry.path());
    }
    if (!found.empty()) break;
  }
  std::ranges::sort(found);
  constexpr std::size_t kMost = 6;
  if (found.size() > kMost) found.resize(kMost);
  return found.empty() ? "none is connected to this machine"
                       : fmt::format("there is {}", fmt::join(found, ", "));
}

std::string GroupOf(const std::string& path) {
  struct stat facts {};
  if (stat(path.c_str(), &facts) != 0) return "dialout";
  const group* const owner = getgrgid(facts.st_gid);
  return owner == nullptr ? std::to_string(facts.st_gid) : owner->gr_name;
}

std::string ReasonNotOpened(const std::string& path, int error) {
  if (error == ENOENT || error == ENXIO || error == ENODEV) {
    return fmt::format("no such device: {}", DevicesHere());
  }
  if (error == EACCES || error == EPERM) {
    return fmt::format(
        "no permission: join its group with `sudo usermod -aG {} $USER` and log in "
        "again",
        GroupOf(path));
  }
  if (error == EBUSY || error == EWOULDBLOCK) {
    return fmt::format("another program uses it (fuser {} tells which): end it", Shown(path));
  }
  return std::strerror(error);
}

/// Asks the driver to pass on bytes at once; what came of it.
std::string LowLatencyFacts(int descriptor, const std::string& path) {
  std::string facts = "low latency is not available";
  serial_struct serial{};
  if (ioctl(descriptor, TIOCGSERIAL, &serial) == 0) {
    serial.flags |= ASYNC_LOW_LATENCY;
    ioctl(descriptor, TIOCSSERIAL, &serial);
    serial.flags = 0;
    ioctl(descriptor, TIOCGSERIAL, &serial);
    if ((serial.flags & ASYNC_LOW_LATENCY) != 0) facts = "low latency";
  }
  std::error_code error;
  const std::filesystem::path name = std::filesystem::canonical(path, error).filename();
  const std::string timer =
      fmt::format("/sys/bus/usb-serial/devices/{}/latency_timer", name.string());
  int timer_ms = 0;
  if (std::ifstream(timer) >> timer_ms) {
    facts += fmt::format(", latency timer {} ms", timer_ms);
    if (timer_ms > 1) facts += fmt::format(" (echo 1 | sudo tee {})", timer);
  }
  return facts;
}

}  // namespace

SerialLine::SerialLine(const DeviceAddress& address) : address_(address) { Open(); }

void SerialLine::Open() {
  const auto fail = [this](const std::string& problem) {
    Close();
    throw UserError({.place = Shown(address_.text), .problem = problem});
  };
  const auto speed = std::ranges::find(kSpeeds, address_.baud, &std::pair<int, speed_t>::first);
  if (speed == kSpeeds.end()) {
    std::vector<int> usual;
    for (const auto& [baud, code] : kSpeeds) {
      if (baud >= 9600 && baud % 9600 == 0) usual.push_back(baud);
    }
    fail(fmt::format("{} baud is no rate of serial lines: {}, 1000000 and more", address_.baud,
                     fmt::join(usual, ", ")));
  }
  const std::string& path = address_.path;
  struct stat facts {};
  if (stat(path.c_str(), &facts) == 0 && !S_ISCHR(facts.st_mode)) {
    fail("is no serial device; a recording is file:PATH");
  }
  line_.Set(open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (!is_open()) fail(ReasonNotOpened(path, errno));
  if (isatty(descriptor()) == 0) fail("is no serial device");
  // TIOCEXCL keeps other programs away, the lock another one of ours that runs as root.
  if (flock(descriptor(), LOCK_EX | LOCK_NB) != 0) fail(ReasonNotOpened(path, errno));
  ioctl(descriptor(), TIOCEXCL);

  termios line{};
  if (tcgetattr(descriptor(), &line) != 0) fail(std::strerror(errno));
  cfmakeraw(&line);
  line.c_cflag |= CLOCAL | CREAD;
  line.c_cflag &= ~static_cast<tcflag_t>(CRTSCTS | CSTOPB);
  line.c_cc[VMIN] = 1;
  line.c_cc[VTIME] = 0;
  cfsetspeed(&line, speed->second);
  if (tcsetattr(descriptor(), TCSANOW, &line) != 0) fail(std::strerror(errno));
  if (tcgetattr(descriptor(), &line) != 0 || cfgetispeed(&line) != speed->second) {
    fail(fmt::format("the device does not take {} baud", address_.baud));
  }
  facts_ = LowLatencyFacts(descriptor(), path);
  if (address_.dtr != DeviceAddress::Dtr::kAsFound) {
    const int dtr = TIOCM_DTR;
    const bool is_on = address_.dtr == DeviceAddress::Dtr::kOn;
    if (ioctl(descriptor(), is_on ? TIOCMBIS : TIOCMBIC, &dtr) != 0) {
      facts_ += ", DTR cannot be set";
    }
  }
  tcflush(descriptor(), TCIFLUSH);  // bytes from before are old
}

std::string SerialLine::Reopen() {
  constexpr std::int64_t kPeriod_ns = kNanosecondsPerSecond / 5;
  const std::int64_t now_ns = MonotonicNow_ns();
  if (now_ns - last_try_ns_ < kPeriod_ns) return why_closed_;
  last_try_ns_ = now_ns;
  why_closed_.clear();
  try {
    Open();
  } catch (const UserError& error) {
    why_closed_ = error.problem();
  }
  return why_closed_;
}

namespace {

class SerialPort : public ByteDevice {
 public:
  explicit SerialPort(const DeviceAddress& address) : line_(address) {}

  FrameSource::State Wait(std::chrono::nanoseconds timeout, const Receiver& receive) override {
    using State = FrameSource::State;
    const std::int64_t end_ns = MonotonicNow_ns() + timeout.count();
    while (!line_.is_open()) {
      problem_ = line_.Reopen();
      if (line_.is_open()) {
        ++counts_.reopened;
        problem_.clear();
        break;
      }
      constexpr std::int64_t kPause_ns = 20'000'000;
      const std::int64_t left_ns = std::min(end_ns - MonotonicNow_ns(), kPause_ns);
      if (left_ns <= 0 || !Sleep(left_ns)) return State::kGone;
    }
    const std::int64_t left_ns = std::max<std::int64_t>(end_ns - MonotonicNow_ns(), 0);
    if (!WaitReadable(line_.descriptor(), std::chrono::nanoseconds(left_ns))) return State::kOpen;
    constexpr int kMostReads = 100;  // a flood must not keep the caller from its own work
    std::array<char, 4096> buffer;
    for (int i = 0; i < kMostReads; ++i) {
      const ssize_t got = read(line_.descriptor(), buffer.data(), buffer.size());
      if (got < 0 && (errno == EAGAIN || errno == EINTR)) break;
      if (got <= 0) {
        problem_ = got < 0 ? std::strerror(errno) : "the device vanished";
        line_.Close();
        return State::kGone;
      }
      counts_.bytes += static_cast<std::uint64_t>(got);
      receive({.bytes = {buffer.data(), static_cast<std::size_t>(got)},
               .arrival_ns = MonotonicNow_ns()});
    }
    return State::kOpen;
  }

  void Write(std::string_view bytes) override {
    if (!line_.is_open()) return;
    // What finds no room is lost: a request is repeated when no answer comes.
    if (write(line_.descriptor(), bytes.data(), bytes.size()) < 0) problem_ = std::strerror(errno);
  }
  ByteFlow flow() const override { return ByteFlow::kCutStream; }
  std::string Facts() const override { return line_.facts(); }

 private:
  /// False after a signal.
  static bool Sleep(std::int64_t time_ns) {
    const timespec time{.tv_sec = 0, .tv_nsec = time_ns};
    return nanosleep(&time, nullptr) == 0;
  }

  SerialLine line_;
};

}  // namespace

std::unique_ptr<ByteDevice> OpenSerialPort(const DeviceAddress& address) {
  return std::make_unique<SerialPort>(address);
}

}  // namespace gauntlet::sim
