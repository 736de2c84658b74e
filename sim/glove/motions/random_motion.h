#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "controller/settings.h"
#include "sim/glove/motions/motion.h"

namespace gauntlet::sim {

/// Band-limited random motion of every channel by itself: a uniform cubic B-spline whose control
/// values are independent and uniform within the range.
///
///     angle(t) = sum_k c_k B3(t / T - k),   spectrum of B3: sinc(f T)^4,  T = 0.2282 / bandwidth
///
/// The curve stays inside the range of its control values (convex hull), has continuous
/// acceleration, and less than 0.1 % of its power above three times the bandwidth. Its amplitude is
/// down to 0.707 at the bandwidth: sinc(0.2282)^4 = 0.707.
struct RandomMotionConfig {
  static constexpr std::string_view kKind = "random";
  static constexpr std::string_view kSummary = "band-limited random motion, each channel by itself";

  double duration_s = 10.0;
  double bandwidth_hz = 0.7;
  double range_percent = 80.0;
  std::vector<std::string> channels = {};  // the others hold

  void Visit(controller::SettingsVisitor& visitor);
};

Motion MakeMotion(const RandomMotionConfig& config, const MotionContext& context);

}  // namespace gauntlet::sim
