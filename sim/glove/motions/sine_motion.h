#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "controller/settings.h"
#include "sim/glove/motions/motion.h"

namespace gauntlet::sim {

/// Every channel swings about the middle of its range.
///
///     angle(t) = middle + half sin(2 pi f t + k phase_step)
///
/// for the moving channels k = 0, 1, ..
struct SineConfig {
  static constexpr std::string_view kKind = "sine";
  static constexpr std::string_view kSummary = "sine of one frequency per channel";

  double duration_s = 10.0;
  std::vector<double> frequency_hz = {0.5};  // one, or one per channel of the glove
  double range_percent = 60.0;
  double phase_step_deg = 0.0;
  std::vector<std::string> channels = {};

  void Visit(controller::SettingsVisitor& visitor);
};
Motion MakeMotion(const SineConfig& config, const MotionContext& context);

/// A sine whose frequency rises evenly in octaves, to see where following ends.
///
///     angle(t) = middle + half sin(phase(t)),   phase'(t) = 2 pi from (to / from)^(t / duration)
struct ChirpConfig {
  static constexpr std::string_view kKind = "chirp";
  static constexpr std::string_view kSummary =
      "sine whose frequency rises evenly in octaves, per channel";

  double duration_s = 20.0;
  std::vector<double> from_hz = {0.1};  // each one, or one per channel of the glove
  std::vector<double> to_hz = {5.0};
  double range_percent = 30.0;
  std::vector<std::string> channels = {};

  void Visit(controller::SettingsVisitor& visitor);
};
Motion MakeMotion(const ChirpConfig& config, const MotionContext& context);

}  // namespace gauntlet::sim
