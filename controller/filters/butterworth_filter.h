#pragma once

#include <string_view>
#include <vector>

#include "controller/export.h"
#include "controller/filters/start.h"
#include "controller/settings.h"

namespace gauntlet::controller {

/// Butterworth low pass: the flattest pass band, -3 dB exactly at the cutoff.
///
///     |H(f)|^2 = 1 / (1 + (tan(pi f / rate) / tan(pi cutoff / rate))^(2 order))
///
/// Bilinear transform with the cutoff pre-warped; second-order sections (and one of first order if
/// the order is odd) in trapezoidal state-variable form, which keeps gain 1 at rest to the last bit
/// even for cutoffs far below the rate, where the coefficients of the direct form cancel.
///
/// Source: Butterworth 1930; Zavalishin, The Art of VA Filter Design (2018), chapters 3 and 4.
/// Errors: SettingError for a cutoff at or above half the rate.
struct GAUNTLET_API ButterworthConfig {
  static constexpr std::string_view kKind = "butterworth";
  static constexpr std::string_view kSummary = "Butterworth low pass of order 1 to 8";

  int order = 2;
  double cutoff_hz = 5.0;  // above nearly all of a hand's motion: an assumption
  Start start = Start::kFirst;

  void Visit(SettingsVisitor& visitor);
};

/// Factors of its sections at a rate, as it steps them. With e = z - s:
///
///     first order    y = s + gain e,                           s += 2 (y - s)
///     second order   v = a1 band + a2 e,   y = s + a2 band + a3 e,
///                    band += 2 (v - band), s += 2 (y - s)       where s is `low`
struct ButterworthFactors {
  struct Section {
    double a1, a2, a3;
  };
  double first_order_gain = 0.0;  // of the first section where the order is odd
  std::vector<Section> sections;
};
/// Errors: SettingError, as the filter's.
GAUNTLET_API ButterworthFactors FactorsOf(const ButterworthConfig& config, double rate_hz);

}  // namespace gauntlet::controller
