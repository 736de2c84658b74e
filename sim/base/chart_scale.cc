#include "sim/base/chart_scale.h"

#include <algorithm>
#include <cmath>

#include "controller/assert.h"

namespace gauntlet::sim {

void Extent::Include(double value) {
  if (!std::isfinite(value)) return;
  low = std::min(low, value);
  high = std::max(high, value);
}

void Extent::Widen(double share) {
  const double margin = high > low ? share * (high - low) : 1.0;
  low -= margin;
  high += margin;
}

double TickStep(const Extent& extent, int count) {
  GAUNTLET_ASSERT(count > 0);
  const double rough = std::max((extent.high - extent.low) / count, 1e-12);
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (rough <= factor * power) return factor * power;
  }
  return 10.0 * power;
}

std::vector<double> Ticks(const Extent& extent, double step) {
  GAUNTLET_ASSERT(step > 0.0);
  constexpr double kRounding = 1e-9;  // of a step
  std::vector<double> ticks;
  const auto last = static_cast<int>(std::floor(extent.high / step + kRounding));
  for (int i = static_cast<int>(std::ceil(extent.low / step - kRounding)); i <= last; ++i) {
    ticks.push_back(i * step);
  }
  return ticks;
}

}  // namespace gauntlet::sim
