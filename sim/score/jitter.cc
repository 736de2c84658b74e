#include "sim/score/jitter.h"

#include <cmath>

#include "controller/assert.h"
#include "sim/score/no_score.h"
#include "sim/score/tracking.h"

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

double AccelerationAbove(const Signal& velocity, double rate_hz, double above_hz,
                         const CountedTicks& counted, Fourier& fourier) {
  const Eigen::Index rows = velocity.rows();
  if (rows < 2) return kNoScore;
  Signal acceleration(rows, velocity.cols());
  acceleration.bottomRows(rows - 1) =
      rate_hz * (velocity.bottomRows(rows - 1) - velocity.topRows(rows - 1));
  acceleration.row(0) = acceleration.row(1);
  const FilteredSignal high = Trembling(acceleration, rate_hz, above_hz, fourier);
  const CountedTicks inner = TremblingWithin(counted, rate_hz, above_hz);
  double squares = 0.0;
  for (Eigen::Index direction = 0; direction < high.values.cols(); ++direction) {
    const std::span values(high.values.col(direction).data(),
                           static_cast<std::size_t>(high.values.rows()));
    const double rms = RmsWithin(values, high.first_sample, inner);
    squares += rms * rms;
  }
  return high.values.rows() == 0 ? kNoScore : std::sqrt(squares);
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
