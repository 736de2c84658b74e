#pragma once

#include <string_view>

#include "controller/settings.h"
#include "sim/glove/faults/fault.h"

namespace gauntlet::sim {

/// Half to all of the amplitude, up or down.
struct SpikeFault {
  static constexpr std::string_view kKind = "spikes";
  static constexpr std::string_view kSummary =
      "values jump away, each for a single sample by default";
  static constexpr FaultNature kNature = {.stage = FaultStage::kAnalog};

  FaultOccurrence when = {.duration_ms = 0.1};
  double amplitude_counts = 200.0;  // of a 10-bit converter

  void Visit(controller::SettingsVisitor& visitor);
  void Apply(FaultStrike& strike) const;
};

/// White noise on top of all other.
struct NoiseBurstFault {
  static constexpr std::string_view kKind = "noise_bursts";
  static constexpr std::string_view kSummary = "stretches of strong noise, as from a motor nearby";
  static constexpr FaultNature kNature = {.stage = FaultStage::kAnalog};

  FaultOccurrence when = {};
  double amplitude_counts = 200.0;  // of a 10-bit converter

  void Visit(controller::SettingsVisitor& visitor);
  void Apply(FaultStrike& strike) const;
};

/// Scales the signal about the middle of the converter's range.
struct GainChangeFault {
  static constexpr std::string_view kKind = "gain_change";
  static constexpr std::string_view kSummary =
      "a sensor slips: its gain changes in mid-run, for good by default";
  static constexpr FaultNature kNature = {.stage = FaultStage::kAnalog};

  FaultOccurrence when = {.start_s = 5.0, .rate_per_s = 0.0, .duration_ms = 0.0};
  double gain = 0.7;

  void Visit(controller::SettingsVisitor& visitor);
  void Apply(FaultStrike& strike) const;
};

/// The glove shifts on the hand: all that a sensor gives moves by as much, up or down.
struct OffsetJumpFault {
  static constexpr std::string_view kKind = "offset_jump";
  static constexpr std::string_view kSummary =
      "a sensor shifts on its joint: its offset jumps in mid-run, for good by default";
  static constexpr FaultNature kNature = {.stage = FaultStage::kAnalog};

  FaultOccurrence when = {.start_s = 5.0, .rate_per_s = 0.0, .duration_ms = 0.0};
  double offset_counts = 40.0;  // of a 10-bit converter

  void Visit(controller::SettingsVisitor& visitor);
  void Apply(FaultStrike& strike) const;
};

}  // namespace gauntlet::sim
