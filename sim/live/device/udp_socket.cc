#include "sim/live/device/udp_socket.h"

#include <fmt/format.h>
#include <netdb.h>
#include <netinet/in.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <memory>
#include <string>

#include "sim/base/descriptor.h"
#include "sim/base/error.h"
#include "sim/base/text.h"
#include "sim/live/device/byte_device.h"
#include "sim/live/device/device_clock.h"

namespace gauntlet::sim {
namespace {

constexpr std::size_t kLargestPacket = 65536;

bool IsMulticast(const SocketAddress& address) {
  if (address.storage.ss_family != AF_INET) return false;
  return IN_MULTICAST(ntohl(reinterpret_cast<const sockaddr_in&>(address.storage).sin_addr.s_addr));
}

/// The host of a packet, without its port.
std::string HostOf(const sockaddr_storage& sender) {
  const auto text = [](const auto& address) {
    return std::string(reinterpret_cast<const char*>(&address), sizeof address);
  };
  if (sender.ss_family == AF_INET6) {
    return text(reinterpret_cast<const sockaddr_in6&>(sender).sin6_addr);
  }
  return text(reinterpret_cast<const sockaddr_in&>(sender).sin_addr);
}

[[noreturn]] void FailToListen(const DeviceAddress& address, int error) {
  std::string problem = std::strerror(error);
  if (error == EADDRINUSE) {
    problem = fmt::format(
        "another program listens on port {} (ss -ulnp lists them): end it, or take another port",
        address.port);
  } else if (error == EADDRNOTAVAIL) {
    problem = fmt::format(
        "{} is no address of this machine: 127.0.0.1 takes packets of this machine alone, 0.0.0.0 "
        "those of all",
        Shown(address.host));
  } else if (error == EACCES) {
    problem = fmt::format("port {} is reserved for the system: take one from 1024", address.port);
  }
  throw UserError({.place = Shown(address.text), .problem = problem});
}

class UdpListener : public ByteDevice {
 public:
  explicit UdpListener(const DeviceAddress& address)
      : socket_(OpenSocket(address)), buffer_(kLargestPacket) {}

  FrameSource::State Wait(std::chrono::nanoseconds timeout, const Receiver& receive) override {
    if (!WaitReadable(socket_.get(), timeout)) return FrameSource::State::kOpen;
    // A flood must not keep the caller from its own work.
    constexpr int kMostPackets = 1000;
    for (int i = 0; i < kMostPackets && TakePacket(receive); ++i) {
    }
    return FrameSource::State::kOpen;
  }
  ByteFlow flow() const override { return ByteFlow::kPackets; }

 private:
  static int OpenSocket(const DeviceAddress& address) {
    const SocketAddress at = FindSocketAddress(address);
    const int descriptor =
        ::socket(at.storage.ss_family, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (descriptor < 0) FailToListen(address, errno);
    const int on = 1;
    setsockopt(descriptor, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof on);
    setsockopt(descriptor, SOL_SOCKET, SO_RXQ_OVFL, &on, sizeof on);
    if (IsMulticast(at)) {
      setsockopt(descriptor, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
      ip_mreqn group{};
      group.imr_multiaddr = reinterpret_cast<const sockaddr_in&>(at.storage).sin_addr;
      setsockopt(descriptor, IPPROTO_IP, IP_ADD_MEMBERSHIP, &group, sizeof group);
    }
    if (bind(descriptor, reinterpret_cast<const sockaddr*>(&at.storage), at.size) != 0) {
      const int error = errno;
      close(descriptor);
      FailToListen(address, error);
    }
    return descriptor;
  }

  bool TakePacket(const Receiver& receive) {
    sockaddr_storage sender{};
    iovec part{.iov_base = buffer_.data(), .iov_len = buffer_.size()};
    alignas(cmsghdr) std::array<char, 256> control;
    msghdr message{};
    message.msg_name = &sender;
    message.msg_namelen = sizeof sender;
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    message.msg_control = control.data();
    message.msg_controllen = control.size();
    const ssize_t got = recvmsg(socket_.get(), &message, 0);
    if (got < 0) return false;
    const std::int64_t now_ns = MonotonicNow_ns();
    std::int64_t arrival_ns = now_ns;
    for (cmsghdr* item = CMSG_FIRSTHDR(&message); item != nullptr;
         item = CMSG_NXTHDR(&message, item)) {
      if (item->cmsg_level != SOL_SOCKET) continue;
      if (item->cmsg_type == SCM_TIMESTAMPNS) {
        timespec stamp{};
        std::memcpy(&stamp, CMSG_DATA(item), sizeof stamp);
        arrival_ns = now_ns - AgeOf_ns(stamp);
      } else if (item->cmsg_type == SO_RXQ_OVFL) {
        std::uint32_t dropped = 0;
        std::memcpy(&dropped, CMSG_DATA(item), sizeof dropped);
        counts_.overflowed = dropped;
      }
    }
    counts_.bytes += static_cast<std::uint64_t>(got);
    if (IsForeign(HostOf(sender), arrival_ns)) {
      ++counts_.foreign;
      problem_ = "packets of another machine than the first one";
      return true;
    }
    receive({.bytes = {buffer_.data(), static_cast<std::size_t>(got)}, .arrival_ns = arrival_ns});
    return true;
  }

  /// The kernel stamps with CLOCK_REALTIME, which may be set meanwhile: an age that cannot be is 0.
  static std::int64_t AgeOf_ns(const timespec& stamp) {
    constexpr std::int64_t kOldest_ns = 10 * kNanosecondsPerSecond;
    const std::int64_t age_ns = NowOf_ns(CLOCK_REALTIME) - Nanoseconds(stamp);
    return age_ns >= 0 && age_ns < kOldest_ns ? age_ns : 0;
  }

  /// Frames of two gloves would alternate. The first machine has the port until it is silent.
  bool IsForeign(const std::string& host, std::int64_t arrival_ns) {
    constexpr std::int64_t kSilence_ns = kNanosecondsPerSecond;
    const bool is_foreign =
        !host_.empty() && host != host_ && arrival_ns - last_arrival_ns_ < kSilence_ns;
    if (is_foreign) return true;
    host_ = host;
    last_arrival_ns_ = arrival_ns;
    return false;
  }

  Descriptor socket_;
  std::vector<char> buffer_;
  std::string host_;
  std::int64_t last_arrival_ns_ = 0;
};

}  // namespace

SocketAddress FindSocketAddress(const DeviceAddress& address) {
  addrinfo wanted{};
  wanted.ai_family = AF_UNSPEC;
  wanted.ai_socktype = SOCK_DGRAM;
  addrinfo* list = nullptr;
  const int error =
      getaddrinfo(address.host.c_str(), std::to_string(address.port).c_str(), &wanted, &list);
  const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> found(list, &freeaddrinfo);
  if (error != 0 || list == nullptr) {
    throw UserError({.place = Shown(address.text),
                     .problem = fmt::format("the host {} is not found: {}", Shown(address.host),
                                            gai_strerror(error))});
  }
  SocketAddress at;
  std::memcpy(&at.storage, list->ai_addr, list->ai_addrlen);
  at.size = list->ai_addrlen;
  return at;
}

std::unique_ptr<ByteDevice> OpenUdpListener(const DeviceAddress& address) {
  return std::make_unique<UdpListener>(address);
}

}  // namespace gauntlet::sim
