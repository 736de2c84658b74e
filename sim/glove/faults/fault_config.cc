#include "sim/glove/faults/fault_config.h"

#include <array>

namespace gauntlet::sim {
namespace {

constexpr std::array<std::string_view, 10> kKindNames = {
    "spikes", "noise_bursts", "gain_change", "time_jitter",       "saturated",
    "stuck",  "disconnected", "dropouts",    "duplicated_frames", "late_frames"};
constexpr std::array<std::string_view, 10> kSummaries = {
    "values jump away, each for a single sample if nothing else is said",
    "stretches of strong noise, as from a motor nearby",
    "a sensor slips: its gain changes in mid-run, for good if nothing else is said",
    "samples are taken a little early or late, all the time if nothing else is said",
    "a channel sits at one end of the converter's scale for a while",
    "a channel repeats its last value for a while",
    "a cable breaks: the channel reads nothing any more, or for as long as is said",
    "values are missing for a while",
    "the channels repeat the frame before for a while, all at once",
    "frames come late for a while, for all channels at once: old values, then a jump"};

FaultConfig DefaultsOf(FaultKind kind) {
  FaultConfig config;
  config.kind = kind;
  switch (kind) {
    case FaultKind::kSpikes:
      break;
    case FaultKind::kGainChange:
    case FaultKind::kDisconnected:
      config.start_s = 5.0;
      config.rate_per_s = 0.0;
      config.duration_ms = 0.0;
      break;
    case FaultKind::kTimeJitter:
      config.start_s = 0.0;
      config.rate_per_s = 0.0;
      config.duration_ms = 0.0;
      break;
    default:
      config.duration_ms = 50.0;
  }
  return config;
}

void VisitAmplitude(controller::SettingsVisitor& visitor, std::string_view help,
                    FaultConfig& config) {
  visitor.Number({.key = "amplitude_counts", .help = help, .min = 0, .max = 1e6},
                 config.amplitude_counts);
}

}  // namespace

void FaultConfig::Visit(controller::SettingsVisitor& visitor) {
  FaultKind visited = kind;
  controller::VisitEnum(visitor, {.key = "kind", .help = "what goes wrong"}, kKindNames, visited);
  if (visited != kind) *this = DefaultsOf(visited);
  visitor.Texts({.key = "channels", .help = "names of the channels; empty: all"}, channels);
  visitor.Number(
      {.key = "start_s", .help = "when it comes first; below 0: at random", .min = -1, .max = 3600},
      start_s);
  visitor.Number({.key = "rate_per_s",
                  .help = "how often it comes (again), on average; 0: never",
                  .min = 0,
                  .max = 1000},
                 rate_per_s);
  visitor.Number({.key = "duration_ms",
                  .help = "mean duration, at least one sample; 0: it stays to the end",
                  .min = 0,
                  .max = 600000},
                 duration_ms);
  switch (kind) {
    case FaultKind::kSpikes:
      return VisitAmplitude(visitor, "largest jump, of a 10-bit converter's counts", *this);
    case FaultKind::kNoiseBursts:
      return VisitAmplitude(visitor, "standard deviation, of a 10-bit converter's counts", *this);
    case FaultKind::kGainChange:
      return visitor.Number(
          {.key = "gain", .help = "factor on what the sensor gives", .min = 0, .max = 10}, gain);
    case FaultKind::kTimeJitter:
      return visitor.Number({.key = "deviation_ms",
                             .help = "standard deviation of the moment of sampling",
                             .min = 0,
                             .max = 100},
                            deviation_ms);
    case FaultKind::kLateFrames:
      return visitor.Number({.key = "delay_ms", .help = "how late", .min = 1, .max = 10000},
                            delay_ms);
    case FaultKind::kSaturated:
    case FaultKind::kStuck:
    case FaultKind::kDisconnected:
    case FaultKind::kDropouts:
    case FaultKind::kDuplicatedFrames:
      return;
  }
}

std::span<const FaultKindInfo> FaultKinds() {
  static const auto kKinds = [] {
    std::array<FaultKindInfo, kKindNames.size()> kinds;
    for (std::size_t i = 0; i < kinds.size(); ++i) {
      kinds[i] = {.name = kKindNames[i],
                  .summary = kSummaries[i],
                  .defaults = DefaultsOf(static_cast<FaultKind>(i))};
    }
    return kinds;
  }();
  return kKinds;
}

}  // namespace gauntlet::sim
