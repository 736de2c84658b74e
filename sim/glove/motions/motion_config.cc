#include "sim/glove/motions/motion_config.h"

namespace gauntlet::sim {

MotionSettings::MotionSettings() = default;
MotionSettings::MotionSettings(const MotionSettings& other) = default;
MotionSettings::MotionSettings(MotionSettings&& other) noexcept = default;
MotionSettings& MotionSettings::operator=(const MotionSettings& other) = default;
MotionSettings& MotionSettings::operator=(MotionSettings&& other) noexcept = default;
MotionSettings::~MotionSettings() = default;

void MotionConfig::Visit(controller::SettingsVisitor& visitor) {
  controller::ChooseKind(visitor, {"kind", "what the wearer does"}, settings);
  visitor.Text({"label",
                "rest, slow, fast, onset or reversal: scored as this, whatever the joints do; any "
                "other name is only stored in the trace; empty: scored by the speed of each joint"},
               label);
  controller::VisitChosen(visitor, settings);
}

std::span<const MotionKind> MotionKinds() { return controller::AllKinds<MotionConfig>(); }

Motion SynthesiseMotion(const MotionConfig& config, const MotionContext& context) {
  Motion motion = std::visit(
      [&context](const auto& settings) { return MakeMotion(settings, context); }, config.settings);
  if (!config.label.empty()) {
    motion.segments = {{config.label, 0, static_cast<int>(motion.angle_rad.rows())}};
  }
  return motion;
}

}  // namespace gauntlet::sim
