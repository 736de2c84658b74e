#include "sim/score/error_causes.h"

#include "controller/assert.h"
#include "sim/score/no_score.h"

namespace gauntlet::sim {

std::optional<ErrorByCauses> PartsOfError(
    std::span<const double> reference, std::span<const double> hand,
    const std::array<std::span<const double>, kCauseTrialCount>& without,
    const CountedTicks& counted) {
  GAUNTLET_ASSERT(reference.size() >= hand.size());
  if (without.back().empty() || CountOf(counted) == 0) return std::nullopt;
  // mean((from - to) e)
  const auto mean_part = [&](std::span<const double> from, std::span<const double> to) {
    GAUNTLET_ASSERT(from.size() >= hand.size() && to.size() >= hand.size());
    double sum = 0.0;
    for (const TickRange& range : counted) {
      for (auto n = static_cast<std::size_t>(range.begin); n < static_cast<std::size_t>(range.end);
           ++n) {
        sum += (from[n] - to[n]) * (hand[n] - reference[n]);
      }
    }
    return sum / CountOf(counted);
  };
  ErrorByCauses parts;
  parts.fill(kNoScore);
  std::span<const double> last = hand;
  for (std::size_t i = 0; i < without.size(); ++i) {
    if (without[i].empty()) continue;
    parts[i] = mean_part(last, without[i]);
    last = without[i];
  }
  parts.back() = mean_part(last, reference);
  return parts;
}

}  // namespace gauntlet::sim
