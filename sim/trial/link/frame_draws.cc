#include "sim/trial/link/frame_draws.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <variant>

#include "sim/base/normal_pair.h"

namespace gauntlet::sim {
namespace {

/// Gamma draw of scale 1 and a shape of 1 or more.
double DrawGamma(double shape, RandomStream& random) noexcept {
  const double d = shape - 1.0 / 3.0;
  const double c = 1.0 / std::sqrt(9.0 * d);
  while (true) {
    const double x = BoxMuller(random).first;
    const double root = 1.0 + c * x;
    if (root <= 0.0) continue;
    const double v = root * root * root;
    if (std::log(random.UniformAboveZero()) < 0.5 * x * x + d - d * v + d * std::log(v)) {
      return d * v;
    }
  }
}

}  // namespace

DelayDraw::DelayDraw(const DelayConfig& config, RandomStream random)
    : settings_(config.settings), random_(random) {
  config.Check();
  if (const auto* histogram = std::get_if<HistogramDelay>(&settings_)) {
    shares_.resize(histogram->counts.size());
    std::partial_sum(histogram->counts.begin(), histogram->counts.end(), shares_.begin());
  }
}

double DelayDraw::Next() noexcept {
  static_assert(std::variant_size_v<DelaySettings> == 4);  // std::visit may throw
  if (const auto* gamma = std::get_if<GammaDelay>(&settings_)) return Of(*gamma);
  if (const auto* quantiles = std::get_if<LogNormalDelay>(&settings_)) return Of(*quantiles);
  if (const auto* histogram = std::get_if<HistogramDelay>(&settings_)) return Of(*histogram);
  return Of(*std::get_if<ConstantDelay>(&settings_));
}

double DelayDraw::Of(const GammaDelay& config) noexcept {
  const double ratio = config.mean_ms / config.deviation_ms;
  const double shape = ratio * ratio;
  const double scale_ms = config.deviation_ms / ratio;
  if (shape >= 1.0) return scale_ms * DrawGamma(shape, random_);
  const double draw = DrawGamma(shape + 1.0, random_);
  return scale_ms * draw * std::pow(random_.UniformAboveZero(), 1.0 / shape);
}

double DelayDraw::Of(const LogNormalDelay& config) noexcept {
  return config.p50_ms * std::exp(config.Deviation() * BoxMuller(random_).first);
}

double DelayDraw::Of(const HistogramDelay& config) noexcept {
  const double place = random_.Uniform() * shares_.back();
  const auto bucket = std::ranges::upper_bound(shares_, place) - shares_.begin();
  return config.bucket_ms * (static_cast<double>(bucket) + random_.Uniform());
}

bool LossDraw::Next() noexcept {
  if (const auto* single = std::get_if<IndependentLoss>(&settings_)) {
    return 100.0 * random_.Uniform() < single->percent;
  }
  const auto* bursts = std::get_if<GilbertElliottLoss>(&settings_);
  if (bursts == nullptr) return false;
  const double change = random_.Uniform();
  in_burst_ =
      in_burst_ ? change * bursts->mean_frames >= 1.0 : 100.0 * change < bursts->begin_percent;
  const double lost = random_.Uniform();  // drawn in both states: the stream stays in step
  return in_burst_ && 100.0 * lost < bursts->lost_percent;
}

}  // namespace gauntlet::sim
