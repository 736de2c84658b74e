#include "sim/score/jitter.h"

namespace gauntlet::sim {
namespace {

constexpr double kTransitionShare = 0.4;  // of the edge, centred on it

}  // namespace

FilteredSignal Trembling(const Signal& angle_rad, double rate_hz, double above_hz,
                         Fourier& fourier) {
  FilteredSignal none{0, Signal(0, angle_rad.cols())};
  const double transition_hz = kTransitionShare * above_hz;
  if (rate_hz <= 2.0 * above_hz + transition_hz) return none;
  const LowPass low_pass = DesignLowPass(above_hz, transition_hz, rate_hz);
  const auto rows = static_cast<double>(angle_rad.rows() - 2 * low_pass.reach());
  if (rows < rate_hz / above_hz) return none;  // not one period of the slowest trembling
  return Filter(low_pass, Band::kAbove, angle_rad, fourier);
}

}  // namespace gauntlet::sim
