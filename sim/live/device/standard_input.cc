#include <poll.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "sim/live/device/byte_device.h"
#include "sim/live/device/device_clock.h"

namespace gauntlet::sim {

bool WaitReadable(int descriptor, std::chrono::nanoseconds timeout) {
  pollfd wait{.fd = descriptor, .events = POLLIN, .revents = 0};
  const std::int64_t most_ns = std::max<std::int64_t>(timeout.count(), 0);
  const timespec limit{.tv_sec = most_ns / kNanosecondsPerSecond,
                       .tv_nsec = most_ns % kNanosecondsPerSecond};
  return ppoll(&wait, 1, &limit, nullptr) > 0;
}

namespace {

class StandardInput : public ByteDevice {
 public:
  FrameSource::State Wait(std::chrono::nanoseconds timeout, const Receiver& receive) override {
    std::array<char, 1 << 16> buffer;
    while (!has_ended_ && WaitReadable(STDIN_FILENO, timeout)) {
      timeout = std::chrono::nanoseconds(0);
      const ssize_t got = read(STDIN_FILENO, buffer.data(), buffer.size());
      if (got < 0 && (errno == EINTR || errno == EAGAIN)) break;
      if (got < 0) problem_ = std::strerror(errno);
      has_ended_ = got <= 0;
      if (has_ended_) break;
      counts_.bytes += static_cast<std::uint64_t>(got);
      receive({.bytes = {buffer.data(), static_cast<std::size_t>(got)},
               .arrival_ns = MonotonicNow_ns()});
    }
    return has_ended_ ? FrameSource::State::kEnded : FrameSource::State::kOpen;
  }

  ByteFlow flow() const override { return ByteFlow::kWholeStream; }

 private:
  bool has_ended_ = false;
};

}  // namespace

std::unique_ptr<ByteDevice> OpenStandardInput() { return std::make_unique<StandardInput>(); }

}  // namespace gauntlet::sim
