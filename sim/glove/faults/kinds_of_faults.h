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
