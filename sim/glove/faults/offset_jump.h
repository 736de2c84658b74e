#pragma once

#include <string_view>

#include "controller/settings.h"
#include "sim/glove/faults/fault.h"

namespace gauntlet::sim {

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
