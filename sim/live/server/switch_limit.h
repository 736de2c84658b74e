#pragma once

#include <chrono>
#include <optional>

namespace gauntlet::sim {

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
