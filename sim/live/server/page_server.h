#pragma once

#include <cstddef>

#include "sim/live/server/live_server.h"
#include "sim/live/server/page_message.h"

namespace gauntlet::sim {

/// Sends a message. It is lost if the ones before it were not taken.
void SendPageMessage(int session, const PageMessage& message) noexcept;

/// Serves a page, in one thread and limited memory, until the session closes its end of `session`.
/// Both sockets must not block. Messages from the session are events of a stream, at most
/// kMostEventBytes each.
///
/// At most kMostRequestBytes of a request are read, and a connection has a limited time for them. A
/// connection too many costs the oldest one whose request is not whole.
///
/// `config` has the port of `listener` and the token. Errors: std::bad_alloc.
void ServePage(const LiveServerConfig& config, int listener, int session);

inline constexpr std::size_t kMostRequestBytes = 8192;
inline constexpr std::size_t kMostEventBytes = std::size_t{1} << 16;
inline constexpr std::size_t kMostConnections = 256;

}  // namespace gauntlet::sim
