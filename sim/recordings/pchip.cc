#include "sim/recordings/pchip.h"

#include <cmath>
#include <vector>

namespace gauntlet::sim {
namespace {

/// Slope at an end point from the first two stretches, bent back where it would overshoot.
double EndSlope(double h0, double h1, double d0, double d1) {
  const double slope = ((2.0 * h0 + h1) * d0 - h0 * d1) / (h0 + h1);
  if (slope * d0 <= 0.0) return 0.0;
  if (d0 * d1 <= 0.0 && std::abs(slope) > 3.0 * std::abs(d0)) return 3.0 * d0;
  return slope;
}

/// As many slopes as points.
std::vector<double> PchipSlopes(std::span<const double> time_s, std::span<const double> value) {
  const std::size_t count = value.size();
  std::vector<double> slopes(count, 0.0);
  if (count < 2) return slopes;
  const auto step = [&](std::size_t k) { return time_s[k + 1] - time_s[k]; };
  const auto secant = [&](std::size_t k) { return (value[k + 1] - value[k]) / step(k); };
  if (count == 2) {
    slopes[0] = slopes[1] = secant(0);
    return slopes;
  }
  for (std::size_t k = 1; k + 1 < count; ++k) {
    const double h0 = step(k - 1), h1 = step(k), d0 = secant(k - 1), d1 = secant(k);
    if (d0 * d1 <= 0.0) continue;
    slopes[k] = 3.0 * (h0 + h1) / ((2.0 * h1 + h0) / d0 + (h1 + 2.0 * h0) / d1);
  }
  slopes[0] = EndSlope(step(0), step(1), secant(0), secant(1));
  slopes[count - 1] =
      EndSlope(step(count - 2), step(count - 3), secant(count - 2), secant(count - 3));
  return slopes;
}

}  // namespace

void InterpolatePchip(std::span<const double> time_s, std::span<const double> value, double start_s,
                      double rate_hz, std::span<double> result) {
  const std::vector<double> slopes = PchipSlopes(time_s, value);
  std::size_t k = 0;
  for (std::size_t i = 0; i < result.size(); ++i) {
    const double t = start_s + i / rate_hz;
    if (t <= time_s.front()) {
      result[i] = value.front();
      continue;
    }
    if (t >= time_s.back()) {
      result[i] = value.back();
      continue;
    }
    while (time_s[k + 1] <= t) ++k;
    const double h = time_s[k + 1] - time_s[k];
    const double u = (t - time_s[k]) / h;
    const double d = value[k + 1] - value[k];
    const double m0 = h * slopes[k], m1 = h * slopes[k + 1];
    // Hermite form as a polynomial in u.
    result[i] = value[k] + u * (m0 + u * (3.0 * d - 2.0 * m0 - m1 + u * (m0 + m1 - 2.0 * d)));
  }
}

}  // namespace gauntlet::sim
