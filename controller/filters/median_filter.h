#pragma once

#include <string_view>

#include "controller/export.h"
#include "controller/settings.h"

namespace gauntlet::controller {

/// The median of the last samples: removes spikes shorter than half the window and keeps edges.
/// Until the window is full it is the median of the samples there are; of an even count the mean of
/// the middle two. Source: Tukey, Exploratory Data Analysis (1977).
struct GAUNTLET_API MedianConfig {
  static constexpr std::string_view kKind = "median";
  static constexpr std::string_view kSummary = "median of the last samples";

  int window = 21;

  void Visit(SettingsVisitor& visitor) {
    visitor.Integer({"window", "samples looked at", 1, 10001}, window);
  }
};

/// Replaces a sample by the median where it lies too far from it, and passes all others unchanged.
///
///     y = median  if |z - median| > threshold_sigma 1.4826 MAD,  else z
///
/// MAD is the median of |sample - median| over the same window, the newest sample included;
/// 1.4826 MAD estimates the standard deviation of normal noise. Windows fill as for the median.
///
/// Where MAD is 0, as of a resting sensor, a sample within the sensor's resolution is no outlier,
/// so that its last digit may flicker. The resolution is what the samples have shown since the
/// start: 1 while all are whole numbers (counts), else the smallest step that the sample in the
/// middle of the window has made, else 0. Source: Hampel, JASA 69 (1974).
struct GAUNTLET_API HampelConfig {
  static constexpr std::string_view kKind = "hampel";
  static constexpr std::string_view kSummary = "replaces outliers by the median, passes the rest";

  int window = 11;
  double threshold_sigma = 3.0;

  void Visit(SettingsVisitor& visitor) {
    visitor.Integer({"window", "samples looked at", 1, 10001}, window);
    visitor.Number({"threshold_sigma",
                    "distance from the median, in standard deviations, that is an outlier", 0, 1e6},
                   threshold_sigma);
  }
};

}  // namespace gauntlet::controller
