#pragma once

#include <cstdint>
#include <span>

#include "sim/score/counted_ticks.h"

namespace gauntlet::sim {

/// Effect of the links on the commands of one trial; empty without links.
struct LinkSignals {
  std::span<const double> sample_age_s;  // of the glove sample behind the command that is held
  std::span<const std::uint8_t> watchdog_tier;  // 0 follow, 1 hold, 2 relax, 3 off
  double ticks_per_command = 20.0;              // frames of the controller

  bool exist() const { return !sample_age_s.empty(); }
};

/// Quantile of the age over the ticks that count [s], at `share`, 0 to 1.
double SampleAge(const LinkSignals& link, double share, const CountedTicks& counted);

/// Share of the ticks at which the command is from the same glove sample as one period of command
/// frames before.
double FrozenShare(const LinkSignals& link, double rate_hz, const CountedTicks& counted);

/// Share of the ticks in a tier.
double TierShare(const LinkSignals& link, int tier, const CountedTicks& counted);

/// Largest change of a motor's command from one tick to the next [counts].
double LargestJump(std::span<const int> command_counts, const CountedTicks& counted);

}  // namespace gauntlet::sim
