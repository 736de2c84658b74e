#include "sim/glove/motions/motion_config.h"

#include <array>
#include <functional>
#include <string>

#include "sim/base/error.h"
#include "sim/glove/motions/segment_labels.h"
#include "sim/glove/motions/sequence.h"

namespace gauntlet::sim {
namespace {

constexpr std::array<std::string_view, 10> kKindNames = {
    HoldConfig::kKind,  RecordedMotionConfig::kKind, RandomMotionConfig::kKind, MovesConfig::kKind,
    GraspConfig::kKind, BurstsConfig::kKind,         SineConfig::kKind,         ChirpConfig::kKind,
    StepsConfig::kKind, SequenceConfig::kKind};
constexpr std::array<std::string_view, 10> kSummaries = {
    HoldConfig::kSummary,    RecordedMotionConfig::kSummary, RandomMotionConfig::kSummary,
    MovesConfig::kSummary,   GraspConfig::kSummary,          BurstsConfig::kSummary,
    SineConfig::kSummary,    ChirpConfig::kSummary,          StepsConfig::kSummary,
    SequenceConfig::kSummary};

/// Calls `use` with the settings of the kind.
template <class Config, class Use>
auto WithSettings(Config& config, const Use& use) {
  switch (config.kind) {
    case MotionKind::kHold:
      return use(config.hold);
    case MotionKind::kRecording:
      return use(config.recording);
    case MotionKind::kRandom:
      return use(config.random);
    case MotionKind::kMoves:
      return use(config.moves);
    case MotionKind::kGrasp:
      return use(config.grasp);
    case MotionKind::kBursts:
      return use(config.bursts);
    case MotionKind::kSine:
      return use(config.sine);
    case MotionKind::kChirp:
      return use(config.chirp);
    case MotionKind::kSteps:
      return use(config.steps);
    case MotionKind::kSequence:
      return use(config.sequence);
  }
  throw controller::SettingError("kind", "is none of the choices");
}

Motion MakeMotion(const SequenceConfig& config, const MotionContext& context) {
  if (config.parts.empty()) {
    throw controller::SettingError("parts", "is empty, must hold at least one motion");
  }
  Motion motion;
  for (std::size_t part = 0; part < config.parts.size(); ++part) {
    MotionContext inner = context;
    inner.part = context.part * 1000 + part + 1;  // unlike any part of another sequence
    if (part > 0) {
      const Eigen::RowVectorXd last = motion.angle_rad.row(motion.angle_rad.rows() - 1);
      inner.start_rad.assign(last.begin(), last.end());
    }
    Motion next = controller::WithinSetting("parts[" + std::to_string(part) + "]", [&] {
      Motion made = SynthesiseMotion(config.parts[part], inner);
      if (made.measured_rad.size() > 0) {
        throw controller::SettingError("use", "is measured, must be truth inside a sequence");
      }
      return made;
    });
    if (part == 0) {
      motion = std::move(next);
    } else {
      AppendMotion(next, config.blend_s, context.rate_hz, motion);
    }
    context.SampleCount(static_cast<double>(motion.angle_rad.rows()) / context.rate_hz);
  }
  return motion;
}

}  // namespace

void SequenceConfig::Visit(controller::SettingsVisitor& visitor) {
  visitor.Number({.key = "blend_s",
                  .help = "time in which each part takes over from the one before",
                  .min = 0.02,
                  .max = 5},
                 blend_s);
  controller::VisitList(visitor, {.key = "parts", .help = "motions, each with kind and settings"},
                        parts);
}

void MotionConfig::Visit(controller::SettingsVisitor& visitor) {
  controller::VisitEnum(visitor, {.key = "kind", .help = "what the wearer does"}, kKindNames, kind);
  visitor.Text(
      {.key = "label",
       .help = "name of this stretch in the scores, as rest, slow or fast; empty: by speed"},
      label);
  WithSettings(*this, [&visitor](auto& settings) { settings.Visit(visitor); });
}

std::span<const MotionKindInfo> MotionKinds() {
  static const auto kKinds = [] {
    std::array<MotionKindInfo, kKindNames.size()> kinds;
    for (std::size_t i = 0; i < kinds.size(); ++i) {
      kinds[i] = {.name = kKindNames[i], .summary = kSummaries[i], .defaults = {}};
      kinds[i].defaults.kind = static_cast<MotionKind>(i);
    }
    return kinds;
  }();
  return kKinds;
}

Motion SynthesiseMotion(const MotionConfig& config, const MotionContext& context) {
  Motion motion = WithSettings(
      config, [&context](const auto& settings) { return MakeMotion(settings, context); });
  if (!config.label.empty()) {
    motion.segments = {{config.label, 0, static_cast<int>(motion.angle_rad.rows())}};
  } else if (motion.segments.empty()) {
    motion.segments = LabelBySpeed(motion.angle_rad, context.rate_hz);
  }
  return motion;
}

}  // namespace gauntlet::sim
