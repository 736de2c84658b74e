#include "sim/trial/link/delay_config.h"

#include <cmath>
#include <numeric>

namespace gauntlet::sim {
namespace {

double MeanOf(const ConstantDelay& delay) { return delay.delay_ms; }
double MeanOf(const GammaDelay& delay) { return delay.mean_ms; }

/// p50 exp(s^2 / 2).
double MeanOf(const LogNormalDelay& delay) {
  const double deviation = delay.Deviation();
  return delay.p50_ms * std::exp(0.5 * deviation * deviation);
}

double MeanOf(const HistogramDelay& delay) {
  double count = 0.0;
  double sum = 0.0;
  for (std::size_t i = 0; i < delay.counts.size(); ++i) {
    count += delay.counts[i];
    sum += delay.counts[i] * (static_cast<double>(i) + 0.5);
  }
  return delay.bucket_ms * sum / count;
}

}  // namespace

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

double LogNormalDelay::Deviation() const {
  constexpr double kZ99 = 2.3263478740408408;
  return std::log(p99_ms / p50_ms) / kZ99;
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

double DelayConfig::MeanMs() const {
  return std::visit([](const auto& delay) { return MeanOf(delay); }, settings);
}

}  // namespace gauntlet::sim
