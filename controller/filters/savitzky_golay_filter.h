#pragma once

#include <memory>
#include <string_view>

#include "controller/filters/filter.h"
#include "controller/settings.h"

namespace gauntlet::controller {

/// Fits a polynomial to the last samples and gives its value at the newest.
///
/// Follows motions up to its order without any lag, and pays with less smoothing: the weight of the
/// newest sample is also the noise gain's square. Passes samples through until its window is full.
/// Source: Savitzky, Golay, Analytical Chemistry 36 (1964); see EndPointWeights().
/// Errors: SettingError for an order that the window cannot determine.
struct SavitzkyGolayConfig {
  static constexpr std::string_view kKind = "savitzky_golay";
  static constexpr std::string_view kSummary =
      "polynomial through the last samples, at the newest of them";

  int window = 41;
  int order = 1;

  void Visit(SettingsVisitor& visitor);
};

std::unique_ptr<Filter> MakeFilter(const SavitzkyGolayConfig& config, int channel_count,
                                   double rate_hz);

}  // namespace gauntlet::controller
