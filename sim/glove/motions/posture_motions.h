#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

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

/// Minimum-jerk moves from posture to posture, with a hold after each.
/// The default speed is a person's unhurried one: an assumption.
struct MovesConfig {
  static constexpr std::string_view kKind = "moves";
  static constexpr std::string_view kSummary = "minimum-jerk moves from posture to posture";

  std::vector<std::string> postures = {"open", "power", "open", "point", "rest"};
  double move_s = 0.8;
  double hold_s = 0.6;
  int repeats = 1;

  void Visit(controller::SettingsVisitor& visitor);
};
Motion MakeMotion(const MovesConfig& config, const MotionContext& context);

/// A grasp of daily life, as people do it: from rest the hand opens while it is carried to the
/// thing, widest at 70 % of the way; the fingers close, the index finger first and each further
/// one 15 ms later; the grasp is held, then let go. All fingers of one grasp close more or less
/// together (a common factor), and each joint a little by itself, so no two grasps are the same.
/// Source: minimum jerk: Flash and Hogan 1985; the widest opening at 60 to 80 % of the reach:
/// Jeannerod 1984; one factor for most of the fingers' variation: Santello, Flanders, Soechting
/// 1998. Lags and durations are assumptions.
struct GraspConfig {
  static constexpr std::string_view kKind = "grasp";
  static constexpr std::string_view kSummary = "grasps of one kind with human timing and synergies";

  std::size_t grasp = 2;  // index of Postures(): power
  int repeats = 3;
  double rest_s = 1.0;
  double reach_s = 0.9;
  double hold_s = 1.2;
  double release_s = 0.6;
  double variation_percent = 8.0;

  void Visit(controller::SettingsVisitor& visitor);
};
Motion MakeMotion(const GraspConfig& config, const MotionContext& context);

/// Opens and closes as fast as a person can, in bursts with pauses.
/// Source of the default: people reach 4 to 6 such movements per second; an assumption here.
struct BurstsConfig {
  static constexpr std::string_view kKind = "bursts";
  static constexpr std::string_view kSummary = "bursts of fast opening and closing";

  int bursts = 3;
  int cycles = 5;
  double frequency_hz = 3.0;
  double pause_s = 1.0;
  double depth_percent = 60.0;

  void Visit(controller::SettingsVisitor& visitor);
};
Motion MakeMotion(const BurstsConfig& config, const MotionContext& context);

/// Jumps between two angles. No joint can do that: it is a test of the step response.
struct StepsConfig {
  static constexpr std::string_view kKind = "steps";
  static constexpr std::string_view kSummary = "jumps between two angles, for step responses";

  double duration_s = 8.0;
  double period_s = 2.0;
  double range_percent = 50.0;
  std::vector<std::string> channels = {};

  void Visit(controller::SettingsVisitor& visitor);
};
Motion MakeMotion(const StepsConfig& config, const MotionContext& context);

}  // namespace gauntlet::sim
