#include "sim/recordings/zero_phase.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace gauntlet::sim {
namespace {

/// y(k) = b (x(k) + 2 x(k-1) + x(k-2)) - a1 y(k-1) - a2 y(k-2)
struct LowPass {
  double b, a1, a2;

  /// Starts as if the first value had been there for ever.
  void Run(std::vector<double>& values) const {
    double x1 = values.front(), x2 = x1, y1 = x1, y2 = x1;
    for (double& value : values) {
      const double y = b * (value + 2.0 * x1 + x2) - a1 * y1 - a2 * y2;
      x2 = x1, x1 = value, y2 = y1, y1 = y;
      value = y;
    }
  }
};

LowPass Butterworth(double cutoff_hz, double rate_hz) {
  // Two passes: the cut-off of one lies higher by (sqrt(2) - 1)^(-1/4) on the warped axis.
  const double warped =
      std::tan(std::numbers::pi * cutoff_hz / rate_hz) / std::pow(std::sqrt(2.0) - 1.0, 0.25);
  const double norm = 1.0 + std::sqrt(2.0) * warped + warped * warped;
  return {warped * warped / norm, 2.0 * (warped * warped - 1.0) / norm,
          (1.0 - std::sqrt(2.0) * warped + warped * warped) / norm};
}

}  // namespace

void SmoothZeroPhase(double cutoff_hz, double rate_hz, std::span<double> values) {
  if (values.size() < 2) return;
  // Six time constants: what the start was is forgotten to 0.2 %.
  const auto reach = std::min(values.size() - 1,
                              static_cast<std::size_t>(std::ceil(1.5 * rate_hz / cutoff_hz)) + 3);
  std::vector<double> padded;
  padded.reserve(values.size() + 2 * reach);
  for (std::size_t i = reach; i >= 1; --i) padded.push_back(2.0 * values.front() - values[i]);
  padded.insert(padded.end(), values.begin(), values.end());
  for (std::size_t i = 1; i <= reach; ++i) {
    padded.push_back(2.0 * values.back() - values[values.size() - 1 - i]);
  }
  const LowPass filter = Butterworth(cutoff_hz, rate_hz);
  filter.Run(padded);
  std::ranges::reverse(padded);
  filter.Run(padded);
  std::ranges::reverse(padded);
  std::copy_n(padded.begin() + reach, values.size(), values.begin());
}

}  // namespace gauntlet::sim
