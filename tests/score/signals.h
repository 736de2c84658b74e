#pragma once

#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "sim/base/random.h"
#include "sim/base/signal.h"
#include "sim/score/counted_ticks.h"

namespace gauntlet::sim {

inline constexpr double kPi = std::numbers::pi;

/// `function(t)` at `rate_hz`.
inline std::vector<double> Sampled(double duration_s, double rate_hz,
                                   const std::function<double(double)>& function) {
  std::vector<double> values(static_cast<std::size_t>(std::lround(duration_s * rate_hz)));
  for (std::size_t n = 0; n < values.size(); ++n) {
    values[n] = function(static_cast<double>(n) / rate_hz);
  }
  return values;
}

/// Standard normal noise of a seed, by the sum of twelve uniform numbers.
inline std::vector<double> Noise(std::size_t count, std::uint64_t seed) {
  RandomStream random(seed, "test noise");
  std::vector<double> values(count);
  for (double& value : values) {
    value = -6.0;
    for (int i = 0; i < 12; ++i) value += random.Uniform();
  }
  return values;
}

/// All of a signal counts.
template <class Values>
CountedTicks All(const Values& values) {
  return {{0, static_cast<int>(values.size())}};
}

/// One column of a Signal.
inline Signal OneChannel(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

}  // namespace gauntlet::sim
