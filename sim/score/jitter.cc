#include "sim/score/jitter.h"

#include <cmath>

#include "controller/assert.h"

namespace gauntlet::sim {
namespace {

constexpr double kTransitionShare = 0.4;  // of the edge, centred on it

int Reach(double rate_hz, double above_hz) {
  GAUNTLET_ASSERT(rate_hz > 0.0 && above_hz > 0.0);
  return LowPassReach(kTransitionShare * above_hz, rate_hz);
}

}  // namespace

FilteredSignal Trembling(const Signal& angle_rad, double rate_hz, double above_hz,
                         Fourier& fourier) {
  FilteredSignal none{0, Signal(0, angle_rad.cols())};
  if (rate_hz <= (2.0 + kTransitionShare) * above_hz) return none;
  if (angle_rad.rows() < TremblingTicks(rate_hz, above_hz)) return none;
  const LowPass low_pass = DesignLowPass(above_hz, kTransitionShare * above_hz, rate_hz);
  return Filter(low_pass, Band::kAbove, angle_rad, fourier);
}

CountedTicks TremblingWithin(const CountedTicks& counted, double rate_hz, double above_hz) {
  const int reach = Reach(rate_hz, above_hz);
  CountedTicks inner;
  for (const TickRange& range : counted) {
    if (range.end - range.begin < TremblingTicks(rate_hz, above_hz)) continue;
    inner.push_back({range.begin + reach, range.end - reach});
  }
  return inner;
}

Eigen::Index TremblingTicks(double rate_hz, double above_hz) {
  // And one period of the slowest jitter.
  return 2 * Reach(rate_hz, above_hz) + static_cast<Eigen::Index>(std::ceil(rate_hz / above_hz));
}

}  // namespace gauntlet::sim
