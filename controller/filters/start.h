#pragma once

#include <array>
#include <string_view>

#include "controller/settings.h"

namespace gauntlet::controller {

/// How a filter starts: as if the first sample had always been there, or from a state of zero.
enum class Start { kFirst, kZero };

inline void VisitStart(SettingsVisitor& visitor, Start& start) {
  static constexpr std::array<std::string_view, 2> kNames = {"first", "zero"};
  VisitEnum(visitor, {"start", "first: the state starts at the first sample; zero: it starts at 0"},
            kNames, start);
}

}  // namespace gauntlet::controller
