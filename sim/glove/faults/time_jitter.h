#pragma once

#include <string_view>

#include "controller/settings.h"
#include "sim/glove/faults/fault.h"

namespace gauntlet::sim {

/// Each sample is taken a little off its time: linear interpolation between what lies beside.
struct TimeJitterFault {
  static constexpr std::string_view kKind = "time_jitter";
  static constexpr std::string_view kSummary =
      "samples are taken a little early or late, all the time by default";
  static constexpr FaultNature kNature = {.stage = FaultStage::kSampling};

  FaultOccurrence when = {.start_s = 0.0, .rate_per_s = 0.0, .duration_ms = 0.0};
  double deviation_ms = 1.0;

  void Visit(controller::SettingsVisitor& visitor);
  void Apply(FaultStrike& strike) const;
};

}  // namespace gauntlet::sim
