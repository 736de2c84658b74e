#include <fmt/format.h>

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
          .like = nullptr};
}

}  // namespace gauntlet::sim
