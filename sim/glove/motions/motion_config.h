#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "controller/settings.h"
#include "sim/glove/motions/hold_motion.h"
#include "sim/glove/motions/motion.h"
#include "sim/glove/motions/posture_motions.h"
#include "sim/glove/motions/random_motion.h"
#include "sim/glove/motions/recorded_motion.h"
#include "sim/glove/motions/sine_motion.h"

namespace gauntlet::sim {

struct MotionConfig;

/// Motions one after another, joined smoothly.
struct SequenceConfig {
  static constexpr std::string_view kKind = "sequence";
  static constexpr std::string_view kSummary = "motions one after another, with labels";

  double blend_s = 0.3;
  std::vector<MotionConfig> parts;

  void Visit(controller::SettingsVisitor& visitor);
};

enum class MotionKind {
  kHold,
  kRecording,
  kRandom,
  kMoves,
  kGrasp,
  kBursts,
  kSine,
  kChirp,
  kSteps,
  kSequence
};

/// What the wearer does.
struct MotionConfig {
  MotionKind kind = MotionKind::kRandom;
  std::string label;  // of the whole of it; empty: labels by its speed
  HoldConfig hold;
  RecordedMotionConfig recording;
  RandomMotionConfig random;
  MovesConfig moves;
  GraspConfig grasp;
  BurstsConfig bursts;
  SineConfig sine;
  ChirpConfig chirp;
  StepsConfig steps;
  SequenceConfig sequence;

  /// Shows the kind and the settings of that kind.
  void Visit(controller::SettingsVisitor& visitor);
};

/// One kind of motion, with the settings it has if nothing is said.
struct MotionKindInfo {
  std::string_view name;
  std::string_view summary;
  MotionConfig defaults;
};

/// All kinds, in the order of every list.
std::span<const MotionKindInfo> MotionKinds();

/// Pure: same input, same bytes.
/// Errors: UserError for a recording that cannot be read, SettingError for settings that do not
/// fit.
Motion SynthesiseMotion(const MotionConfig& config, const MotionContext& context);

}  // namespace gauntlet::sim
