#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "sim/fit/pose_recording.h"

namespace gauntlet::sim {
namespace {

/// None if the channel has too few different values; 0 if they have no common step.
std::optional<double> StepOf(std::span<const double> values) {
  constexpr std::size_t kFewestLevels = 8;
  constexpr double kNearSteps = 5.0;
  constexpr double kTolerance = 0.25;  // steps
  std::vector<double> levels(values.begin(), values.end());
  std::ranges::sort(levels);
  levels.erase(std::unique(levels.begin(), levels.end()), levels.end());
  if (levels.size() < kFewestLevels) return std::nullopt;
  double step = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < levels.size(); ++i) step = std::min(step, levels[i] - levels[i - 1]);
  std::size_t single = 0;
  for (std::size_t i = 1; i < levels.size(); ++i) {
    const double steps = (levels[i] - levels[i - 1]) / step;
    if (steps > kNearSteps + 0.5) continue;
    if (std::abs(steps - std::round(steps)) > kTolerance) return 0.0;
    single += std::round(steps) == 1.0 ? 1 : 0;
  }
  return 2 * single >= levels.size() - 1 ? step : 0.0;
}

}  // namespace

double ResolutionOf(const Signal& values) {
  std::optional<double> smallest;
  bool all_whole = true;
  for (Eigen::Index c = 0; c < values.cols(); ++c) {
    const std::span<const double> channel(values.col(c).data(),
                                          static_cast<std::size_t>(values.rows()));
    const bool is_whole =
        std::ranges::all_of(channel, [](double value) { return value == std::round(value); });
    all_whole = all_whole && is_whole;
    std::optional<double> step = StepOf(channel);
    if (is_whole && step == 0.0) step = 1.0;
    if (step) smallest = std::min(*step, smallest.value_or(*step));
  }
  return smallest.value_or(all_whole ? 1.0 : 0.0);
}

}  // namespace gauntlet::sim
