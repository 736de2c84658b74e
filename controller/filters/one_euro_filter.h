#pragma once

#include <string_view>

#include "controller/export.h"
#include "controller/settings.h"

namespace gauntlet::controller {

/// The 1 euro filter: a first-order low pass that opens when the signal moves fast.
///
///     dz(k)  = (z(k) - y(k-1)) rate            speed_from: filtered, as the reference does since
///                                              August 2023
///     dz(k)  = (z(k) - z(k-1)) rate            speed_from: raw, as MediaPipe and older copies do
///     d(k)   = d(k-1) + a(derivative_cutoff_hz) (dz(k) - d(k-1)),       d(0) = 0
///     f(k)   = min_cutoff_hz + beta |d(k)|
///     y(k)   = y(k-1) + a(f(k)) (z(k) - y(k-1)),                        y(0) = z(0)
///     a(f)   = 1 / (1 + rate / (2 pi f))
///
/// Source: Casiez, Roussel, Vogel, CHI 2012 (hal-00670496). Units: beta in Hz per (input unit / s),
/// so its useful size depends on whether counts or angles are filtered.
struct GAUNTLET_API OneEuroConfig {
  static constexpr std::string_view kKind = "one_euro";
  static constexpr std::string_view kSummary = "low pass whose cutoff rises with the speed";

  /// The value that the speed counts from: the last filtered one, or the last sample.
  enum class SpeedFrom { kFiltered, kRaw };

  // The defaults of the reference.
  double min_cutoff_hz = 1.0;
  double beta = 0.0;
  double derivative_cutoff_hz = 1.0;
  SpeedFrom speed_from = SpeedFrom::kFiltered;

  void Visit(SettingsVisitor& visitor);
};

}  // namespace gauntlet::controller
