#pragma once

#include <cstddef>
#include <string_view>

#include "controller/settings.h"
#include "sim/glove/motions/motion.h"

namespace gauntlet::sim {

/// Nothing moves.
struct HoldConfig {
  static constexpr std::string_view kKind = "hold";
  static constexpr std::string_view kSummary = "holds a posture still";

  double duration_s = 2.0;
  std::size_t posture = 0;  // 0: as before; then index + 1 of Postures()

  void Visit(controller::SettingsVisitor& visitor);
};

Motion MakeMotion(const HoldConfig& config, const MotionContext& context);

}  // namespace gauntlet::sim
