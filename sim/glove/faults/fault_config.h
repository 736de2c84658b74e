#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "controller/settings.h"

namespace gauntlet::sim {

enum class FaultKind {
  kSpikes,
  kNoiseBursts,
  kGainChange,
  kTimeJitter,
  kSaturated,
  kStuck,
  kDisconnected,
  kDropouts,
  kDuplicatedFrames,
  kLateFrames
};

/// Something that goes wrong with the glove, again and again: the first time at `start_s` or at
/// random, then at random, as often as `rate_per_s` says in each of the channels. Gaps and
/// durations are exponential about their means. Counts are those of a 10-bit converter.
struct FaultConfig {
  FaultKind kind = FaultKind::kSpikes;
  std::vector<std::string> channels;  // empty: all
  double start_s = -1.0;              // of the first; below 0: at random
  double rate_per_s = 0.5;            // 0: never (again)
  double duration_ms = 0.1;           // 0: to the end
  double amplitude_counts = 200.0;
  double gain = 0.7;
  double deviation_ms = 1.0;
  double delay_ms = 20.0;

  /// Shows the kind and the settings of that kind; another kind brings its own defaults.
  void Visit(controller::SettingsVisitor& visitor);
};

/// One kind of fault, with the settings it has if nothing is said.
struct FaultKindInfo {
  std::string_view name;
  std::string_view summary;
  FaultConfig defaults;
};
std::span<const FaultKindInfo> FaultKinds();

}  // namespace gauntlet::sim
