#include "sim/score/jitter.h"

namespace gauntlet::sim {
namespace {

constexpr double kCutoff_hz = 10.0;     // the definition of jitter in the project's design
constexpr double kTransition_hz = 4.0;  // centred on the cutoff

}  // namespace

FilteredSignal Trembling(const Signal& angle_rad, double rate_hz, Fourier& fourier) {
  FilteredSignal none{0, Signal(0, angle_rad.cols())};
  if (rate_hz <= 2.0 * kCutoff_hz + kTransition_hz) return none;
  const LowPass low_pass = DesignLowPass(kCutoff_hz, kTransition_hz, rate_hz);
  const auto rows = static_cast<double>(angle_rad.rows() - 2 * low_pass.reach());
  if (rows < rate_hz / kCutoff_hz) return none;  // not one period of the slowest trembling
  return Filter(low_pass, Band::kAbove, angle_rad, fourier);
}

}  // namespace gauntlet::sim
