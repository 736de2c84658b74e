#include "sim/glove/faults/fault_config.h"

#include <array>

namespace gauntlet::sim {
namespace {

constexpr std::array<std::string_view, 10> kKindNames = {
    "spikes", "noise_bursts", "gain_change", "time_jitter",       "saturated",
    "stuck",  "disconnected", "dropouts",    "duplicated_frames", "late_frames"};
constexpr std::array<std::string_view, 10> kSummaries = {
    "single samples jump away",
    "stretches of strong noise, as from a motor nearby",
    "a sensor slips: its gain changes in mid-run and stays so",
    "samples are taken a little early or late",
    "a channel sits at one end of the converter's scale for a while",
    "a channel repeats its last value for a while",
    "a cable breaks: from then on the channel reads nothing",
    "values are missing for a while",
    "all channels repeat the frame before for a while",
    "frames come late for a while: old values, then a jump"};

void VisitRate(controller::SettingsVisitor& visitor, FaultConfig& config, bool whole_frame) {
  visitor.Number({.key = "rate_per_s",
                  .help = whole_frame ? "how often" : "how often in each channel",
                  .min = 0,
                  .max = 1000},
                 config.rate_per_s);
}

void VisitMeanDuration(controller::SettingsVisitor& visitor, FaultConfig& config) {
  visitor.Number({.key = "duration_ms", .help = "mean duration", .min = 1, .max = 600000},
                 config.duration_ms);
}

void VisitAmplitude(controller::SettingsVisitor& visitor, std::string_view help,
                    FaultConfig& config) {
  visitor.Number({.key = "amplitude_counts", .help = help, .min = 0, .max = 1e6},
                 config.amplitude_counts);
}

void VisitStart(controller::SettingsVisitor& visitor, FaultConfig& config) {
  visitor.Number({.key = "start_s", .help = "when it happens", .min = 0, .max = 3600},
                 config.start_s);
}

}  // namespace

void FaultConfig::Visit(controller::SettingsVisitor& visitor) {
  controller::VisitEnum(visitor, {.key = "kind", .help = "what goes wrong"}, kKindNames, kind);
  const bool whole_frame = kind == FaultKind::kDuplicatedFrames || kind == FaultKind::kLateFrames;
  if (!whole_frame) {
    visitor.Texts({.key = "channels", .help = "names of the channels; empty: all"}, channels);
  }
  switch (kind) {
    case FaultKind::kSpikes:
      VisitRate(visitor, *this, whole_frame);
      VisitAmplitude(visitor, "largest jump, of a 10-bit converter's counts", *this);
      return;
    case FaultKind::kNoiseBursts:
      VisitRate(visitor, *this, whole_frame);
      VisitMeanDuration(visitor, *this);
      VisitAmplitude(visitor, "standard deviation, of a 10-bit converter's counts", *this);
      return;
    case FaultKind::kGainChange:
      VisitStart(visitor, *this);
      visitor.Number(
          {.key = "gain", .help = "factor on what the sensor gives", .min = 0, .max = 10}, gain);
      return;
    case FaultKind::kTimeJitter:
      visitor.Number({.key = "deviation_ms",
                      .help = "standard deviation of the moment of sampling",
                      .min = 0,
                      .max = 100},
                     deviation_ms);
      return;
    case FaultKind::kDisconnected:
      return VisitStart(visitor, *this);
    case FaultKind::kSaturated:
    case FaultKind::kStuck:
    case FaultKind::kDropouts:
    case FaultKind::kDuplicatedFrames:
      VisitRate(visitor, *this, whole_frame);
      return VisitMeanDuration(visitor, *this);
    case FaultKind::kLateFrames:
      VisitRate(visitor, *this, whole_frame);
      VisitMeanDuration(visitor, *this);
      visitor.Number({.key = "delay_ms", .help = "how late", .min = 1, .max = 10000}, delay_ms);
      return;
  }
}

std::span<const FaultKindInfo> FaultKinds() {
  static const auto kKinds = [] {
    std::array<FaultKindInfo, kKindNames.size()> kinds;
    for (std::size_t i = 0; i < kinds.size(); ++i) {
      kinds[i] = {.name = kKindNames[i], .summary = kSummaries[i], .defaults = {}};
      kinds[i].defaults.kind = static_cast<FaultKind>(i);
    }
    return kinds;
  }();
  return kKinds;
}

}  // namespace gauntlet::sim
