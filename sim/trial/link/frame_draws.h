#pragma once

#include <vector>

#include "sim/base/random.h"
#include "sim/trial/link/link_config.h"

namespace gauntlet::sim {

/// Draws how long frames are on their way, one after the other.
///
/// Source: gamma: Marsaglia and Tsang 2000, below shape 1 by G(k + 1) U^(1/k).
class DelayDraw {
 public:
  DelayDraw(const DelayConfig& config, RandomStream random);

  /// Delay of the next frame [ms].
  double Next() noexcept;

 private:
  double Of(const ConstantDelay& config) noexcept { return config.delay_ms; }
  double Of(const GammaDelay& config) noexcept;
  double Of(const LogNormalDelay& config) noexcept;
  double Of(const HistogramDelay& config) noexcept;

  DelaySettings settings_;
  RandomStream random_;
  std::vector<double> shares_;  // of a histogram, summed up to each bucket
};

/// Draws whether frames are lost, one after the other.
class LossDraw {
 public:
  LossDraw(const LossConfig& config, RandomStream random)
      : settings_(config.settings), random_(random) {}

  /// True if the next frame is lost.
  bool Next() noexcept;

 private:
  LossSettings settings_;
  RandomStream random_;
  bool in_burst_ = false;
};

}  // namespace gauntlet::sim
