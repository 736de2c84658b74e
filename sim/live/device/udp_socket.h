#pragma once

#include <sys/socket.h>

#include <cstdint>

#include "sim/live/device/address.h"

namespace gauntlet::sim {

/// A socket that closes itself.
class Socket {
 public:
  explicit Socket(int descriptor) : descriptor_(descriptor) {}
  ~Socket();
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;

  int descriptor() const { return descriptor_; }

 private:
  int descriptor_;
};

/// An address of the system for a host and a port.
struct SocketAddress {
  sockaddr_storage storage = {};
  socklen_t size = 0;
};

/// Errors: UserError for a host that is not found.
SocketAddress FindSocketAddress(const DeviceAddress& address);

}  // namespace gauntlet::sim
