#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "sim/settings/libraries/library.h"

namespace gauntlet::sim {
namespace {

std::string ScipyBody(const controller::ExponentialConfig& config, double /*rate_hz*/) {
  return fmt::format(R"(    alpha = {}
    start = [(1 - alpha) * samples[0]]
    return signal.lfilter([alpha], [1, alpha - 1], samples, zi=start)[0]
)",
                     LineNumber(config.alpha));
}
std::string ScipyBody(const controller::ButterworthConfig& config, double rate_hz) {
  const bool from_first = config.start == controller::Start::kFirst;
  return fmt::format(R"(    sections = signal.butter({}, {}, fs={}, output="sos")
{}    return signal.sosfilt(sections, samples{}
)",
                     config.order, LineNumber(config.cutoff_hz), LineNumber(rate_hz),
                     from_first ? "    start = signal.sosfilt_zi(sections) * samples[0]\n" : "",
                     from_first ? ", zi=start)[0]" : ")");
}
std::string ScipyBody(const controller::MovingAverageConfig& config, double /*rate_hz*/) {
  return fmt::format(R"(    count = np.minimum(np.arange(len(samples)) + 1, {0})
    return signal.lfilter(np.ones({0}), 1, samples) / count
)",
                     config.window);
}
std::string ScipyBody(const controller::SavitzkyGolayConfig& config, double /*rate_hz*/) {
  return fmt::format(R"(    window, order = {}, {}
    weights = signal.savgol_coeffs(window, order, pos=window - 1)  # at the newest sample
    filtered = np.array(samples, dtype=float)  # the first ones pass unchanged
    filtered[window - 1:] = np.convolve(samples, weights, "valid")
    return filtered
)",
                     config.window, config.order);
}
std::string ScipyBody(const auto& /*config*/, double /*rate_hz*/) { return ""; }

std::string ScipyLines(const PlainFilter& filter) {
  const std::string lines = std::visit(
      [&](const auto& config) { return ScipyBody(config, filter.rate_hz); }, filter.settings);
  if (lines.empty()) return "";
  return "import numpy as np\nfrom scipy import signal\n\ndef smooth(samples):\n" + lines;
}

/// Arguments of scipy.signal.butter().
class ButterLike final : public LikeSettings {
 public:
  void Visit(controller::SettingsVisitor& visitor) override {
    visitor.Integer({.key = "N", .help = "order", .min = 1, .max = 8, .required = true}, order_);
    visitor.Number({.key = "Wn",
                    .help = "cutoff frequency, in Hz with fs, else as a share of half the rate",
                    .min = 0,
                    .max = 1e6,
                    .required = true,
                    .open_range = true},
                   cutoff_);
    visitor.Number({"fs", "rate of the samples; 0: Wn is a share", 0, 1e6}, rate_hz_);
  }
  controller::FilterSettings At(double rate_hz) const override {
    const bool is_share = rate_hz_ == 0.0;
    const double end = is_share ? 1.0 : 0.5 * std::min(rate_hz_, rate_hz);
    if (!(cutoff_ < end)) {
      throw controller::SettingError(
          "Wn", fmt::format("is {:g}, must be below {:g}{}", cutoff_, end,
                            is_share ? ", which is half the rate, without fs" : " Hz"));
    }
    return controller::ButterworthConfig{.order = order_,
                                         .cutoff_hz = is_share ? cutoff_ * 0.5 * rate_hz : cutoff_};
  }

 private:
  int order_ = 2;
  double cutoff_ = 0.1;
  double rate_hz_ = 0.0;
};

}  // namespace

Library ScipySignal() {
  return {.name = "scipy",
          .package = "scipy 1.17.1 (PyPI)",
          .comment = "#",
          .kinds = {controller::ExponentialConfig::kKind, controller::ButterworthConfig::kKind,
                    controller::MovingAverageConfig::kKind, controller::SavitzkyGolayConfig::kKind},
          .differences = {"It has no times: resample an uneven recording first.",
                          "A missing sample (NaN) makes all later ones NaN, or those of its "
                          "window: give the last good sample again.",
                          "savgol_filter() and filtfilt() look ahead: these lines do not."},
          .lines = ScipyLines,
          .like = MakeLike<ButterLike>,
          .like_kind = controller::ButterworthConfig::kKind};
}

}  // namespace gauntlet::sim
