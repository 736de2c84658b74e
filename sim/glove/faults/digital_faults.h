#pragma once

#include <string_view>

#include "controller/settings.h"
#include "sim/glove/faults/fault.h"

namespace gauntlet::sim {

/// The channel reads 0 or full scale.
struct SaturatedFault {
  static constexpr std::string_view kKind = "saturated";
  static constexpr std::string_view kSummary =
      "a channel sits at one end of the converter's scale for a while";
  static constexpr FaultNature kNature = {.stage = FaultStage::kDigital};

  FaultOccurrence when = {};

  void Visit(controller::SettingsVisitor&) {}
  void Apply(FaultStrike& strike) const;
};

/// The channel repeats the value before.
struct StuckFault {
  static constexpr std::string_view kKind = "stuck";
  static constexpr std::string_view kSummary = "a channel repeats its last value for a while";
  static constexpr FaultNature kNature = {.stage = FaultStage::kDigital};

  FaultOccurrence when = {};

  void Visit(controller::SettingsVisitor&) {}
  void Apply(FaultStrike& strike) const;
};

/// Values are missing, once and for good.
struct DisconnectedFault {
  static constexpr std::string_view kKind = "disconnected";
  static constexpr std::string_view kSummary =
      "a cable breaks: the channel reads nothing any more, or for as long as is said";
  static constexpr FaultNature kNature = {.stage = FaultStage::kDigital};

  FaultOccurrence when = {.start_s = 5.0, .rate_per_s = 0.0, .duration_ms = 0.0};

  void Visit(controller::SettingsVisitor&) {}
  void Apply(FaultStrike& strike) const;
};

/// Values are missing, again and again.
struct DropoutFault {
  static constexpr std::string_view kKind = "dropouts";
  static constexpr std::string_view kSummary = "values are missing for a while";
  static constexpr FaultNature kNature = {.stage = FaultStage::kDigital};

  FaultOccurrence when = {};

  void Visit(controller::SettingsVisitor&) {}
  void Apply(FaultStrike& strike) const;
};

/// The frame before is sent again and again.
struct DuplicatedFrameFault {
  static constexpr std::string_view kKind = "duplicated_frames";
  static constexpr std::string_view kSummary =
      "the channels repeat the frame before for a while, all at once";
  static constexpr FaultNature kNature = {.stage = FaultStage::kDigital, .of_frames = true};

  FaultOccurrence when = {};

  void Visit(controller::SettingsVisitor&) {}
  void Apply(FaultStrike& strike) const;
};

/// Frames arrive `delay_ms` after their time: a late frame shows a frame from before, as it was
/// before it came late itself.
struct LateFrameFault {
  static constexpr std::string_view kKind = "late_frames";
  static constexpr std::string_view kSummary =
      "frames come late for a while, for all channels at once: old values, then a jump";
  static constexpr FaultNature kNature = {
      .stage = FaultStage::kDigital, .of_frames = true, .last_first = true};

  FaultOccurrence when = {};
  double delay_ms = 20.0;

  void Visit(controller::SettingsVisitor& visitor);
  void Apply(FaultStrike& strike) const;
};

}  // namespace gauntlet::sim
