#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "controller/sample_guard_config.h"
#include "controller/settings.h"

namespace gauntlet::sim {

/// The analog-digital converters: they round to whole counts and clip at both ends of their scale,
/// which is min_counts to min_counts + 2^bits - 1.
///
/// Shapes: one value for all channels, or a list as described at GloveConfig.
/// Source: 10 bits is an assumption; the paper's variances R fit a converter of this size.
struct ConverterConfig {
  std::vector<double> bits = {10.0};
  std::vector<double> min_counts = {0.0};  // below 0: signed

  /// Bits for a channel of KnownChannels().
  double bits_of(std::size_t channel) const;
  controller::ConverterRange range(std::size_t channel) const;
  /// Ranges of each channel of KnownChannels().
  std::vector<controller::ConverterRange> ranges() const;

  /// Errors: SettingError for lists of a wrong length, or numbers that are not whole.
  void Check() const;
  void Visit(controller::SettingsVisitor& visitor);
};

/// Whole counts for an analog value [counts].
inline double Convert(double analog_counts, const controller::ConverterRange& range) {
  return std::clamp(std::nearbyint(analog_counts), range.min_counts, range.full_scale_counts);
}

}  // namespace gauntlet::sim
