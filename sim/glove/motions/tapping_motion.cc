#include "sim/glove/motions/tapping_motion.h"

#include <algorithm>

#include "sim/base/channels.h"
#include "sim/glove/motions/minimum_jerk.h"
#include "sim/glove/motions/postures.h"
#include "sim/glove/motions/settings_of_motions.h"

namespace gauntlet::sim {
namespace {

void VisitSeconds(controller::SettingsVisitor& visitor, std::string_view key, std::string_view help,
                  double& value) {
  visitor.Number({.key = key, .help = help, .min = 0.05, .max = 60}, value);
}

/// Down and up again, at every `cycle_s` from `first_s` on.
std::vector<Move> TapsOf(const TappingConfig& config, double depth_rad, double first_s,
                         double cycle_s) {
  std::vector<Move> moves;
  const double half_s = 0.5 * config.tap_s;
  for (double start_s = first_s; start_s + config.tap_s <= config.duration_s; start_s += cycle_s) {
    moves.push_back({.start_s = start_s, .duration_s = half_s, .delta_rad = depth_rad});
    moves.push_back({.start_s = start_s + half_s, .duration_s = half_s, .delta_rad = -depth_rad});
  }
  return moves;
}

}  // namespace

void TappingConfig::Visit(controller::SettingsVisitor& visitor) {
  VisitDuration(visitor, duration_s);
  VisitSeconds(visitor, "interval_s", "from one tap to that of the next channel", interval_s);
  VisitSeconds(visitor, "tap_s", "how long a tap is, down and up", tap_s);
  visitor.Number({"depth_deg", "how far a joint bends, within its range", 0, 150}, depth_deg);
  visitor.Texts({"channels", "names of the channels that tap; empty: all of them"}, channels);
}

Motion MakeMotion(const TappingConfig& config, const MotionContext& context) {
  Motion motion = StillMotion(context.SampleCount(config.duration_s));
  const std::vector<bool> selected = SelectChannels(config.channels);
  const std::vector<double> rest = context.start_rad.empty() ? PostureAngles(0) : context.start_rad;
  const auto tapping = std::ranges::count(selected, true);
  const double cycle_s = std::max(static_cast<double>(tapping) * config.interval_s, config.tap_s);
  double first_s = config.interval_s;
  for (std::size_t channel = 0; channel < selected.size(); ++channel) {
    if (!selected[channel]) {
      HoldChannel(channel, rest[channel], motion);
      continue;
    }
    const double room_rad = KnownChannels()[channel].max_deg * kRadPerDeg - rest[channel];
    const double depth_rad =
        std::clamp(config.depth_deg * kRadPerDeg, 0.0, std::max(0.0, room_rad));
    MoveChannel(channel, rest[channel], TapsOf(config, depth_rad, first_s, cycle_s),
                context.rate_hz, motion);
    first_s += config.interval_s;
  }
  return motion;
}

}  // namespace gauntlet::sim
