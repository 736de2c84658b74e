#include "sim/score/motors.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "controller/assert.h"
#include "sim/score/no_score.h"

namespace gauntlet::sim {
namespace {

constexpr double kPiece_s = 1.0;

std::vector<double> HannWindow(int size) {
  std::vector<double> window(size);
  for (int n = 0; n < size; ++n) {
    window[n] = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * n / size);
  }
  return window;
}

}  // namespace

double SpectralCentroid(std::span<const double> speed, double rate_hz, const CountedTicks& counted,
                        Fourier& fourier) {
  GAUNTLET_ASSERT(rate_hz > 0.0 && AreWithin(counted, std::ssize(speed)));
  const int samples = CountOf(counted);
  const int size = FastTransformSize(static_cast<int>(kPiece_s * rate_hz));
  double mean = 0.0;
  for (const TickRange& range : counted) {
    for (int n = range.begin; n < range.end; ++n) mean += speed[n] / samples;
  }

  const std::vector<double> window = HannWindow(size);
  const int hop = std::max(1, size / 2);
  std::vector<double> power(size / 2 + 1);
  Fourier::Values pair;
  for (const TickRange& range : counted) {
    for (int start = range.begin; start + size <= range.end; start += 2 * hop) {
      // Two pieces as real and imaginary part: |Z[k]|^2 + |Z[-k]|^2 is twice the sum of their
      // powers.
      pair.assign(size, 0.0);
      const bool two = start + hop + size <= range.end;
      for (int n = 0; n < size; ++n) {
        const double first = window[n] * (speed[start + n] - mean);
        const double second = two ? window[n] * (speed[start + hop + n] - mean) : 0.0;
        pair[n] = {first, second};
      }
      fourier.Forward(pair);
      for (int k = 1; k <= size / 2; ++k) {
        power[k] += std::norm(pair[k]) + std::norm(pair[size - k]);
      }
    }
  }
  double sum = 0.0;
  double weighted = 0.0;
  for (int k = 1; k <= size / 2; ++k) {
    sum += power[k];
    weighted += power[k] * k;
  }
  // Rounding leaves some 1e-30 of a constant speed.
  const double floor = 1e-24 * (1.0 + mean * mean) * size * samples;
  return sum > floor ? weighted / sum * rate_hz / size : kNoScore;
}

double SlackShare(std::span<const double> tension_n, const CountedTicks& counted) {
  GAUNTLET_ASSERT(AreWithin(counted, std::ssize(tension_n)));
  return ShareOfTicks(counted, [&](int n) { return tension_n[n] <= kSlackTension_n; });
}

}  // namespace gauntlet::sim
