#pragma once

#include <string_view>

#include "controller/export.h"
#include "controller/settings.h"

namespace gauntlet::controller {

/// Fits a polynomial to the last samples and gives its value at the newest.
///
/// Follows motions up to its order without any lag, and pays with less smoothing: the weight of the
/// newest sample is also the noise gain's square. Passes samples through until its window is full.
/// Source: Savitzky, Golay, Analytical Chemistry 36 (1964); see EndPointWeights().
/// Errors: SettingError for an order that the window cannot determine.
struct GAUNTLET_API SavitzkyGolayConfig {
  static constexpr std::string_view kKind = "savitzky_golay";
  static constexpr std::string_view kSummary =
      "polynomial through the last samples, at the newest of them";

  int window = 41;
  int order = 1;

  void Visit(SettingsVisitor& visitor);
};

}  // namespace gauntlet::controller
