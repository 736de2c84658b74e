#include "controller/same_connections.h"

#include <algorithm>
#include <tuple>

namespace gauntlet::controller {

bool SameConnections(const RobotConfig& a, const RobotConfig& b) {
  const auto glove = [](const GloveCalibration& g) {
    return std::tie(g.channel_names, g.low_counts, g.high_counts, g.low_angle_rad, g.high_angle_rad,
                    g.frame_number_bits);
  };
  const auto hand = [](const TendonTransmission& h) {
    return std::tie(h.joint_names, h.motor_names, h.coupling, h.motor_of_joint,
                    h.reference_angle_rad, h.joint_min_rad, h.joint_max_rad, h.counts_per_rad,
                    h.center_counts, h.min_counts, h.max_counts, h.joint_sensors);
  };
  const auto clocks = [](const Timing& t) {
    return std::tie(t.tick_rate_hz, t.ticks_per_sample, t.event_period_ms, t.glove_rate_hz);
  };
  const auto same_source = [](const JointSource& s, const JointSource& t) {
    return std::tie(s.joint, s.channels, s.weights, s.offset_deg) ==
           std::tie(t.joint, t.channels, t.weights, t.offset_deg);
  };
  return glove(a.glove) == glove(b.glove) && ConvertersOf(a.glove) == ConvertersOf(b.glove) &&
         hand(a.hand) == hand(b.hand) && clocks(a.timing) == clocks(b.timing) &&
         std::ranges::equal(a.joint_map.joints, b.joint_map.joints, same_source);
}

}  // namespace gauntlet::controller
