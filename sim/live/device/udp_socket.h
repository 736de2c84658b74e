#pragma once

#include <sys/socket.h>

#include "sim/live/device/address.h"

namespace gauntlet::sim {

/// An address of the system for a host and a port.
struct SocketAddress {
  sockaddr_storage storage = {};
  socklen_t size = 0;
};

/// Errors: UserError for a host that is not found.
SocketAddress FindSocketAddress(const DeviceAddress& address);

}  // namespace gauntlet::sim
