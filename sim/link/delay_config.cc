#include "sim/link/delay_config.h"

#include <numeric>

namespace gauntlet::sim {

using controller::NumberText;
using controller::SettingError;
using controller::SettingsVisitor;

void ConstantDelay::Visit(SettingsVisitor& visitor) {
  visitor.Number({"delay_ms", "time on the way", 0, kLongestDelayMs}, delay_ms);
}

void GammaDelay::Visit(SettingsVisitor& visitor) {
  constexpr double kLeast = 1e-6;
  visitor.Number({"mean_ms", "mean time on the way", kLeast, kLongestDelayMs}, mean_ms);
  visitor.Number({"deviation_ms", "standard deviation of the time on the way", kLeast, 1000},
                 deviation_ms);
}

void LogNormalDelay::Visit(SettingsVisitor& visitor) {
  visitor.Number({"p50_ms", "median time on the way", 0.01, kLongestDelayMs}, p50_ms);
  visitor.Number({"p99_ms", "time that 99 % of the frames do not exceed", 0.01, kLongestDelayMs},
                 p99_ms);
}

void HistogramDelay::Visit(SettingsVisitor& visitor) {
  visitor.Number({"bucket_ms", "width of a bucket; the first begins at 0", 0.01, 1000}, bucket_ms);
  visitor.Numbers({"counts", "frames in each bucket, or their shares", 0, 1e12}, counts);
}

void DelayConfig::Check() const {
  if (const auto* quantiles = std::get_if<LogNormalDelay>(&settings)) {
    if (quantiles->p99_ms >= quantiles->p50_ms) return;
    throw SettingError("p99_ms", "is " + NumberText(quantiles->p99_ms) +
                                     ", must be at least p50_ms, " + NumberText(quantiles->p50_ms));
  }
  if (const auto* histogram = std::get_if<HistogramDelay>(&settings)) {
    if (std::accumulate(histogram->counts.begin(), histogram->counts.end(), 0.0) <= 0.0) {
      throw SettingError("counts", "have the sum 0, must have a value above 0");
    }
    const double longest_ms = histogram->bucket_ms * static_cast<double>(histogram->counts.size());
    if (longest_ms > kLongestDelayMs) {
      throw SettingError("counts", "reach up to " + NumberText(longest_ms) + " ms, must end at " +
                                       NumberText(kLongestDelayMs) + " ms");
    }
  }
}

}  // namespace gauntlet::sim
