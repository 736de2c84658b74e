#include "sim/trial/link/link_config.h"

#include <cmath>
#include <numeric>

#include "sim/trial/link/presets.h"

namespace gauntlet::sim {
namespace {

using controller::NumberText;
using controller::SettingError;
using controller::SettingsVisitor;

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

void VisitWindow(SettingsVisitor& visitor, double& window_ms) {
  visitor.Number(
      {"window_ms", "how long a measured delay counts: the sender's clock drifts", 100, 600000},
      window_ms);
}

}  // namespace

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

void IndependentLoss::Visit(SettingsVisitor& visitor) {
  visitor.Number({"percent", "frames that are lost", 0, 100}, percent);
}

void GilbertElliottLoss::Visit(SettingsVisitor& visitor) {
  visitor.Number({"begin_percent", "frames at which a burst of losses begins", 0, 100},
                 begin_percent);
  visitor.Number({"mean_frames", "mean length of a burst", 1, 100000}, mean_frames);
  visitor.Number({"lost_percent", "frames of a burst that are lost", 0, 100}, lost_percent);
}

bool TransportConfig::has_jitter() const {
  return !std::holds_alternative<ConstantDelay>(delay.settings) || batch_ms > 0.0;
}

TransportConfig TransportConfig::WithoutJitter() const {
  TransportConfig steady = *this;
  // The wait for the next batch is uniform from 0 to its interval.
  steady.delay.settings = ConstantDelay{.delay_ms = delay.MeanMs() + 0.5 * batch_ms};
  steady.batch_ms = 0.0;
  return steady;
}

void TransportConfig::Visit(SettingsVisitor& visitor) {
  static const std::vector<std::string_view> kNames = [] {
    std::vector<std::string_view> names;
    for (const LinkPreset& known : LinkPresets()) names.push_back(known.name);
    return names;
  }();
  const std::size_t before = preset;
  std::size_t chosen = preset;
  visitor.Choice({"preset", "a known link; gives its values to the settings below"}, kNames,
                 chosen);
  if (chosen != before && chosen < kNames.size()) {
    *this = LinkPresets()[chosen].transport;
    preset = chosen;
  }
  controller::VisitGroup(visitor, {"delay", "time of a frame on its way"}, delay);
  controller::VisitGroup(visitor, {"loss", "which frames are lost"}, loss);
  visitor.Number({"frame_ms", "time for which a frame occupies the link; 0: none waits", 0, 1000},
                 frame_ms);
  visitor.Number(
      {"batch_ms", "frames arrive together at multiples of this interval; 0: each by itself", 0,
       1000},
      batch_ms);
}

void QueueReceiver::Visit(SettingsVisitor& visitor) {
  visitor.Integer({"longest_frames", "frames that wait at most; more are lost", 1, 100000},
                  longest_frames);
}

void BufferReceiver::Visit(SettingsVisitor& visitor) {
  visitor.Number({"delay_ms", "time in which late frames may still arrive", 0, 1000}, delay_ms);
  VisitWindow(visitor, window_ms);
}

void AdaptiveBufferReceiver::Visit(SettingsVisitor& visitor) {
  visitor.Number({"quantile_percent", "frames that are to arrive in time", 1, 100},
                 quantile_percent);
  visitor.Number({"longest_ms", "longest buffer", 1, 1000}, longest_ms);
  VisitWindow(visitor, window_ms);
}

void PredictGap::Visit(SettingsVisitor& visitor) {
  visitor.Number({"slope_ms", "time over which the slope is measured", 1, 1000}, slope_ms);
  visitor.Number({"longest_ms", "time after which the extrapolation stays", 0, 1000}, longest_ms);
}

void TieredWatchdog::Visit(SettingsVisitor& visitor) {
  visitor.Number({"hold_after_ms", "time without a frame until the command is held", 1, 100000},
                 hold_after_ms);
  visitor.Number(
      {"relax_after_ms", "until the motors turn to the hand's reference posture", 1, 100000},
      relax_after_ms);
  visitor.Number({"off_after_ms",
                  "until motors lose their torque, or a computer stops sending frames", 1, 100000},
                 off_after_ms);
  visitor.Number({"relax_deg_s", "speed of the spools when they relax", 0.1, 10000}, relax_deg_s);
  visitor.Number(
      {"return_deg_s", "largest speed of the spools until they follow again", 0.1, 100000},
      return_deg_s);
  visitor.Integer({"good_frames", "new frames until the hand follows again", 1, 10000},
                  good_frames);
}

void WatchdogConfig::Check() const {
  const auto* tiers = std::get_if<TieredWatchdog>(&settings);
  if (tiers == nullptr) return;
  const auto check = [](const char* key, double value, const char* before, double least) {
    if (value >= least) return;
    throw SettingError(
        key, "is " + NumberText(value) + ", must be at least " + before + ", " + NumberText(least));
  };
  check("relax_after_ms", tiers->relax_after_ms, "hold_after_ms", tiers->hold_after_ms);
  check("off_after_ms", tiers->off_after_ms, "relax_after_ms", tiers->relax_after_ms);
}

void LinkConfig::Check() const {
  controller::CheckSettings(*this);
  controller::WithinSetting("delay", [this] { transport.delay.Check(); });
  controller::WithinSetting("watchdog", [this] { watchdog.Check(); });
}

void LinksConfig::Check() const {
  if (glove) controller::WithinSetting("link.glove", [this] { glove->Check(); });
  if (hand) controller::WithinSetting("link.hand", [this] { hand->Check(); });
}

}  // namespace gauntlet::sim
