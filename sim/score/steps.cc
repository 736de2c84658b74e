#include "sim/score/steps.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "controller/assert.h"
#include "sim/score/no_score.h"

namespace gauntlet::sim {
namespace {

constexpr double kWaiting_s = 1.0;  // for the hand, after the wearer has arrived
// What counts as the rest before a movement: a slow start has already moved when it is noticed.
constexpr double kBaselineBegin_s = 0.3;
constexpr double kBaselineEnd_s = 0.2;
constexpr double kOnsetShare = 0.1;
constexpr double kSurelyMovingShare = 0.5;

double Mean(std::span<const double> values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

double MeanDifference(std::span<const double> wearer, std::span<const double> hand,
                      const CountedTicks& counted) {
  double sum = 0.0;
  for (const TickRange& range : counted) {
    for (int n = range.begin; n < range.end; ++n) sum += hand[n] - wearer[n];
  }
  return sum / CountOf(counted);
}

/// Share of the step from one sample to the next that lies below a level.
double ShareBelow(double level, double now, double next) {
  if (now < level && next < level) return 1.0;
  if (now >= level && next >= level) return 0.0;
  return (level - std::min(now, next)) / std::abs(next - now);
}

/// How long, in samples, the angle stays near the baseline after the wearer has begun to move.
std::optional<double> SamplesBeforeOnset(std::span<const double> angle, const Movement& movement,
                                         double baseline, int end) {
  const auto travel = [&](int n) { return movement.direction() * (angle[n] - baseline); };
  const double onset_rad = kOnsetShare * movement.amplitude_rad();
  const double moving_rad = kSurelyMovingShare * movement.amplitude_rad();
  double below = 0.0;
  for (int n = movement.begin; n + 1 < end; ++n) {
    if (travel(n) >= moving_rad) return below;
    below += ShareBelow(onset_rad, travel(n), travel(n + 1));
  }
  return std::nullopt;
}

}  // namespace

double Overshoot(std::span<const double> wearer_rad, std::span<const double> hand_rad,
                 double rate_hz, std::span<const Movement> movements, double delay_samples,
                 const CountedTicks& counted) {
  GAUNTLET_ASSERT(hand_rad.size() == wearer_rad.size());
  GAUNTLET_ASSERT(AreWithin(counted, std::ssize(wearer_rad)));
  const double offset = MeanDifference(wearer_rad, hand_rad, counted);
  const int delay = static_cast<int>(std::lround(std::max(0.0, delay_samples)));
  double sum = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < movements.size(); ++i) {
    const Movement& movement = movements[i];
    if (movement.end + delay + 1 >= movement.within.end) continue;  // the hand has not arrived
    int end = movement.end + static_cast<int>(kWaiting_s * rate_hz);
    if (i + 1 < movements.size()) {
      const Movement& next = movements[i + 1];
      end = std::min(end, next.direction() == movement.direction() ? next.begin : next.end);
    }
    end = std::min(end + delay, movement.within.end);
    double beyond = 0.0;
    for (int n = movement.begin; n < end; ++n) {
      beyond = std::max(beyond, movement.direction() * (hand_rad[n] - offset - movement.to_rad));
    }
    sum += beyond;
    ++count;
  }
  return count == 0 ? kNoScore : sum / count;
}

double OnsetDelay(std::span<const double> wearer_rad, std::span<const double> hand_rad,
                  double rate_hz, std::span<const Movement> movements) {
  GAUNTLET_ASSERT(rate_hz > 0.0 && hand_rad.size() == wearer_rad.size());
  const int first = static_cast<int>(kBaselineBegin_s * rate_hz);
  const int last = std::min(first - 1, static_cast<int>(kBaselineEnd_s * rate_hz));
  double sum = 0.0;
  int count = 0;
  for (const Movement& movement : movements) {
    if (!movement.from_rest || movement.begin - movement.within.begin < first) continue;
    const auto baseline = [&](std::span<const double> angle) {
      return Mean(angle.subspan(movement.begin - first, first - last));
    };
    const int end =
        std::min(movement.within.end, movement.end + static_cast<int>(kWaiting_s * rate_hz));
    const auto wearer = SamplesBeforeOnset(wearer_rad, movement, baseline(wearer_rad), end);
    const auto hand = SamplesBeforeOnset(hand_rad, movement, baseline(hand_rad), end);
    if (!wearer || !hand) continue;
    sum += *hand - *wearer;
    ++count;
  }
  return count == 0 ? kNoScore : sum / count;
}

}  // namespace gauntlet::sim
