#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "controller/sample_guard_config.h"
#include "controller/settings.h"
#include "sim/base/random.h"

namespace gauntlet::sim {

/// When and where faults of one kind strike: the first time at `start_s` or at random, then at
/// random, as often as `rate_per_s` says in each of the channels. Gaps and durations are
/// exponential about their means. The settings that all kinds have; each has its own defaults.
struct FaultOccurrence {
  std::vector<std::string> channels = {};  // empty: all
  double start_s = -1.0;                   // of the first; below 0: at random
  double rate_per_s = 0.5;                 // 0: never (again)
  double duration_ms = 50.0;               // 0: to the end

  void Visit(controller::SettingsVisitor& visitor);
};

/// Stage on the way of a sample at which a fault acts.
enum class FaultStage {
  kSampling,  // the moments of sampling, before there is noise, which no sampling makes smaller
  kAnalog,    // the electrical signal, before the converter
  kDigital,   // the frames, behind the converter: a missing value is NaN
};

/// Properties that every fault of one kind has.
struct FaultNature {
  FaultStage stage;
  bool of_frames = false;   // strikes all its channels at once
  bool last_first = false;  // is applied from the last to the first: it looks back at what was
                            // there before any of them
};

/// One fault that is to be applied: in one channel, at samples [begin, end).
struct FaultStrike {
  Eigen::Ref<Eigen::VectorXd> column;  // the whole signal of the channel [counts]
  Eigen::Index begin;
  Eigen::Index end;
  double rate_hz;
  controller::ConverterRange converter;
  RandomStream& random;  // of this fault alone

  auto stretch() { return column.segment(begin, end - begin); }
  /// Amplitudes are given in counts of a 10-bit converter; this one's counts.
  double ScaledCounts(double counts) const { return counts * converter.span_counts() / 1023.0; }
};

}  // namespace gauntlet::sim
