#pragma once

#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "controller/kinds.h"
#include "controller/settings.h"
#include "sim/glove/motions/motion.h"
#include "sim/glove/motions/posture_motions.h"
#include "sim/glove/motions/random_motion.h"
#include "sim/glove/motions/recorded_motion.h"
#include "sim/glove/motions/sequence.h"
#include "sim/glove/motions/sine_motion.h"

namespace gauntlet::sim {

/// Every kind of motion that there is. To add one: a file with its config and its MakeMotion(), and
/// one entry here.
class MotionSettings : public std::variant<HoldConfig, RecordedMotionConfig, RandomMotionConfig,
                                           MovesConfig, GraspConfig, BurstsConfig, SineConfig,
                                           ChirpConfig, StepsConfig, SequenceConfig> {
 public:
  using variant::variant;
  MotionSettings();
  MotionSettings(const MotionSettings& other);
  MotionSettings(MotionSettings&& other) noexcept;
  MotionSettings& operator=(const MotionSettings& other);
  MotionSettings& operator=(MotionSettings&& other) noexcept;
  ~MotionSettings();
};

/// Motion of the wearer: `kind`, `label`, then the settings of that kind.
struct MotionConfig {
  MotionSettings settings = RandomMotionConfig{};
  std::string label = {};  // of the whole of it; empty: none, or those of a sequence's parts

  std::string_view kind() const { return controller::KindName(settings); }
  void Visit(controller::SettingsVisitor& visitor);
};

/// All kinds, in the order of every list.
using MotionKind = controller::Kind<MotionConfig>;
std::span<const MotionKind> MotionKinds();

/// Pure: same input, same bytes.
/// Errors: UserError for a recording that cannot be read, SettingError for settings that do not
/// fit.
Motion SynthesiseMotion(const MotionConfig& config, const MotionContext& context);

}  // namespace gauntlet::sim
