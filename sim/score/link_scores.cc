#include "sim/score/link_scores.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "sim/base/quantile.h"
#include "sim/score/no_score.h"

namespace gauntlet::sim {

double SampleAge(const LinkSignals& link, double share, const CountedTicks& counted) {
  std::vector<double> ages_s;
  for (const TickRange& range : counted) {
    const auto part = link.sample_age_s.subspan(range.begin, range.end - range.begin);
    ages_s.insert(ages_s.end(), part.begin(), part.end());
  }
  return Quantile(std::move(ages_s), share);
}

double FrozenShare(const LinkSignals& link, double rate_hz, const CountedTicks& counted) {
  const int before = std::max(1, static_cast<int>(std::ceil(link.ticks_per_command)));
  const auto capture = [&](int tick) {
    return tick - std::llround(link.sample_age_s[static_cast<std::size_t>(tick)] * rate_hz);
  };
  return ShareOfTicks(
      counted, [&](int n) { return capture(n) == capture(n - before); }, before);
}

double TierShare(const LinkSignals& link, int tier, const CountedTicks& counted) {
  return ShareOfTicks(
      counted, [&](int n) { return link.watchdog_tier[static_cast<std::size_t>(n)] == tier; });
}

double LargestJump(std::span<const int> command_counts, const CountedTicks& counted) {
  double largest = kNoScore;
  for (const TickRange& range : counted) {
    for (int n = range.begin + 1; n < range.end; ++n) {
      const double jump = std::abs(static_cast<double>(command_counts[n]) - command_counts[n - 1]);
      if (!(jump <= largest)) largest = jump;
    }
  }
  return largest;
}

}  // namespace gauntlet::sim
