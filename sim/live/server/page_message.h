#pragma once

#include <cstddef>
#include <cstdint>

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

}  // namespace gauntlet::sim
