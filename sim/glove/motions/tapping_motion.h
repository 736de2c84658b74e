#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "controller/settings.h"
#include "sim/glove/motions/motion.h"

namespace gauntlet::sim {

/// Joints tap one after another, over and over, as fingers on a table: each bends by `depth_deg`
/// and goes back, both with least jerk, while the others rest.
/// Source of the course: Flash and Hogan 1985. Depth and times are assumptions.
struct TappingConfig {
  static constexpr std::string_view kKind = "tapping";
  static constexpr std::string_view kSummary = "fingers tap one after another";

  double duration_s = 10.0;
  double interval_s = 0.4;  // from one tap to the next
  double tap_s = 0.3;       // down and up
  double depth_deg = 30.0;
  std::vector<std::string> channels = {"index_mcp", "middle_mcp", "ring_mcp", "little_mcp"};

  void Visit(controller::SettingsVisitor& visitor);
};
Motion MakeMotion(const TappingConfig& config, const MotionContext& context);

}  // namespace gauntlet::sim
