#pragma once

#include <string_view>
#include <variant>
#include <vector>

#include "controller/kinds.h"
#include "controller/settings.h"

namespace gauntlet::sim {

/// No frame takes longer: one that would is lost.
inline constexpr double kLongestDelayMs = 10'000.0;

/// Equal time for every frame.
struct ConstantDelay {
  static constexpr std::string_view kKind = "constant";
  static constexpr std::string_view kSummary = "every frame takes the same time";

  double delay_ms = 0.0;

  void Visit(controller::SettingsVisitor& visitor);
};

/// Gamma distribution by mean m and standard deviation s: shape (m / s)^2, scale s^2 / m.
struct GammaDelay {
  static constexpr std::string_view kKind = "gamma";
  static constexpr std::string_view kSummary = "gamma distribution, by mean and deviation";

  double mean_ms = 10.0;
  double deviation_ms = 5.0;

  void Visit(controller::SettingsVisitor& visitor);
};

/// Log-normal distribution by two quantiles: p50 exp(s z), s = ln(p99 / p50) / z_99, z normal.
struct LogNormalDelay {
  static constexpr std::string_view kKind = "log_normal";
  static constexpr std::string_view kSummary = "log-normal distribution, by median and p99";

  double p50_ms = 5.0;
  double p99_ms = 20.0;

  /// s, the standard deviation of the logarithm.
  double Deviation() const;
  void Visit(controller::SettingsVisitor& visitor);
};

/// A measured histogram from 0 on; uniform within a bucket.
struct HistogramDelay {
  static constexpr std::string_view kKind = "histogram";
  static constexpr std::string_view kSummary = "a measured histogram, uniform within each bucket";

  double bucket_ms = 1.0;
  std::vector<double> counts = {1.0};

  void Visit(controller::SettingsVisitor& visitor);
};

using DelaySettings = std::variant<ConstantDelay, GammaDelay, LogNormalDelay, HistogramDelay>;

/// How long a frame is on its way.
struct DelayConfig {
  DelaySettings settings;

  void Visit(controller::SettingsVisitor& visitor) {
    controller::VisitKind(visitor, {"kind", "distribution of the time on the way"}, settings);
  }
  /// Errors: SettingError for quantiles that do not rise and an empty histogram.
  void Check() const;
  /// Mean of the distribution [ms], of settings that Check() accepts.
  double MeanMs() const;
};

}  // namespace gauntlet::sim
