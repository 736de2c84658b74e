#include "sim/glove/motions/motion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "controller/assert.h"
#include "controller/settings.h"
#include "sim/base/channels.h"
#include "sim/base/error.h"
#include "sim/base/stop.h"
#include "sim/glove/motions/postures.h"

namespace gauntlet::sim {

namespace {

constexpr double kLongest_s = 3600.0;

/// Ranges in which the thumb, away from the palm, meets no finger wherever the other joints are: in
/// none of 10,000 postures that are uniform over these ranges and those of all other joints.
constexpr std::array<Channel, 3> kClearOfFingers = {{
    {"thumb_rotation", 0, 45, ""},
    {"thumb_abduction", 45, 60, ""},
    {"thumb_mcp", 0, 30, ""},
}};

}  // namespace

int MotionContext::SampleCount(double duration_s) const {
  if (duration_s > kLongest_s) {
    throw controller::SettingError("", "lasts " + controller::NumberText(duration_s) +
                                           " s, must be at most " +
                                           controller::NumberText(kLongest_s));
  }
  return std::max(1, static_cast<int>(std::lround(duration_s * rate_hz)));
}

std::vector<double> MotionContext::StartAngles(std::size_t posture) const {
  return start_rad.empty() ? PostureAngles(posture) : start_rad;
}

Motion StillMotion(int samples) {
  Motion motion;
  motion.angle_rad.setZero(samples, static_cast<Eigen::Index>(KnownChannels().size()));
  return motion;
}

Motion MoveChannels(const std::vector<std::string>& names, int samples,
                    const MotionContext& context,
                    const std::function<void(std::size_t, int, Motion&)>& move) {
  Motion motion = StillMotion(samples);
  const std::vector<bool> selected = SelectChannels(names);
  const std::vector<double> rest = context.StartAngles();
  int number = 0;
  for (std::size_t channel = 0; channel < selected.size(); ++channel) {
    ThrowIfStopped();
    if (selected[channel]) {
      move(channel, number++, motion);
    } else {
      HoldChannel(channel, rest[channel], motion);
    }
    TrimSignals();
  }
  return motion;
}

void HoldChannel(std::size_t channel, double angle_rad, Motion& motion) {
  GAUNTLET_ASSERT(std::cmp_less(channel, motion.angle_rad.cols()));
  motion.angle_rad.col(static_cast<Eigen::Index>(channel)).setConstant(angle_rad);
  TrimSignals();
}

std::vector<bool> SelectChannels(const std::vector<std::string>& names) {
  std::vector<bool> selected(KnownChannels().size(), names.empty());
  for (const std::string& name : names) {
    try {
      selected[static_cast<std::size_t>(ChannelIndex(name))] = true;
    } catch (const UserError& error) {
      throw controller::SettingError("channels", error.what());
    }
  }
  return selected;
}

Excursion ChannelExcursion(std::size_t channel, double range_percent) {
  GAUNTLET_ASSERT(channel < KnownChannels().size());
  const Channel& whole = KnownChannels()[channel];
  const auto clear = std::ranges::find(kClearOfFingers, whole.name, &Channel::name);
  const Channel& joint = clear != kClearOfFingers.end() ? *clear : whole;
  return {0.5 * (joint.max_deg + joint.min_deg) * kRadPerDeg,
          0.005 * range_percent * (joint.max_deg - joint.min_deg) * kRadPerDeg};
}

}  // namespace gauntlet::sim
