#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "sim/live/server/live_server.h"

namespace gauntlet::sim {

/// A message from the process of the page to that of the session, of a fixed size.
struct PageMessage {
  enum class Kind : std::int32_t {
    kSwitch,  // number: of a controller, as in LiveView::Ask()
    kMark,    // number: 1: the hand is still from now on, 0: it moves
    kEnded,   // the server ended. number: of its signal; 0: none; -1: it had no memory left
  };
  Kind kind = Kind::kSwitch;
  std::int32_t number = 0;
};

/// True for a message that the page of a session with so many controllers can send. Its process
/// reads third-party bytes, so its messages are not trusted.
inline bool IsOfPage(const PageMessage& message, std::size_t controllers) {
  const auto number = static_cast<std::int64_t>(message.number);
  constexpr std::int64_t kLargestSignal = 64;
  switch (message.kind) {
    case PageMessage::Kind::kSwitch:
      return number >= 0 && number < static_cast<std::int64_t>(controllers);
    case PageMessage::Kind::kMark:
      return number == 0 || number == 1;
    case PageMessage::Kind::kEnded:
      return number >= -1 && number <= kLargestSignal;
  }
  return false;
}

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

/// At most one switch of the controller in half a second.
class SwitchLimit {
 public:
  bool Allow() {
    constexpr auto kBetween = std::chrono::milliseconds(500);
    const auto now = std::chrono::steady_clock::now();
    if (last_ && now - *last_ < kBetween) return false;
    last_ = now;
    return true;
  }

 private:
  std::optional<std::chrono::steady_clock::time_point> last_;
};

}  // namespace gauntlet::sim
