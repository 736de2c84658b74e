#pragma once

#include <string_view>
#include <vector>

#include "controller/settings.h"
#include "sim/glove/motions/motion.h"

namespace gauntlet::sim {

struct MotionConfig;

/// Motions one after another, joined smoothly. The labels of its parts are the segments.
struct SequenceConfig {
  static constexpr std::string_view kKind = "sequence";
  static constexpr std::string_view kSummary = "motions one after another, with labels";

  double blend_s = 0.3;
  std::vector<MotionConfig> parts;

  void Visit(controller::SettingsVisitor& visitor);
};

/// Errors: SettingError for a sequence without parts, with a part that a glove measured, or of more
/// than an hour.
Motion MakeMotion(const SequenceConfig& config, const MotionContext& context);

/// Puts `next` behind `motion`, joined so that angle, velocity and acceleration are continuous.
///
/// Over the first `blend_s` of `next` a fifth-order polynomial is added that takes up the
/// differences at the joint and is zero with its derivatives at its end.
void AppendMotion(Motion next, double blend_s, double rate_hz, Motion& motion);

}  // namespace gauntlet::sim
