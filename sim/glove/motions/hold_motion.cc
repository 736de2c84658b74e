#include "sim/glove/motions/hold_motion.h"

#include "sim/glove/motions/postures.h"
#include "sim/glove/motions/settings_of_motions.h"

namespace gauntlet::sim {
namespace {

const std::vector<std::string_view>& ChoiceNames() {
  static const auto kNames = [] {
    std::vector<std::string_view> names = {"as_before"};
    names.insert(names.end(), PostureNames().begin(), PostureNames().end());
    return names;
  }();
  return kNames;
}

}  // namespace

void HoldConfig::Visit(controller::SettingsVisitor& visitor) {
  VisitDuration(visitor, duration_s);
  visitor.Choice({"posture", "what is held; as_before is rest at the start"}, ChoiceNames(),
                 posture);
}

Motion MakeMotion(const HoldConfig& config, const MotionContext& context) {
  Motion motion = StillMotion(context.SampleCount(config.duration_s));
  std::vector<double> angles = PostureAngles(config.posture == 0 ? 0 : config.posture - 1);
  if (config.posture == 0 && !context.start_rad.empty()) angles = context.start_rad;
  for (std::size_t channel = 0; channel < angles.size(); ++channel) {
    HoldChannel(channel, angles[channel], motion);
  }
  return motion;
}

}  // namespace gauntlet::sim
