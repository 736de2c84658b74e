#pragma once

#include <string_view>
#include <vector>

#include "controller/export.h"
#include "controller/settings.h"

namespace gauntlet::controller {

/// A bank of Kalman filters, each for another way to move, mixed by how far each has missed of
/// late. So one setting serves rest, slow motion and fast, channel by channel.
///
///     y_m(k)  = what filter m expects at k + h
///     miss_m  = mean of (z(k) - y_m(k - h))^2 over about `memory_ms`, in units of r
///     y(k)    = sum of g_m y_m(k),   g_m = miss_m^-3 / sum of all miss^-3
///
/// The bank: a hand at rest, which does not look ahead; one whose acceleration stays; one that
/// swings at 0.5, 1, 2 and 3 Hz around a middle that wanders. The mixture is never beyond the
/// farthest of the bank, and its shares change no faster than the memory lets them. A miss counts
/// as 0.1 standard deviations at least and 100 at most. At a horizon below one step misses are
/// those of one step.
///
/// Source: weights by past losses as in Vovk, "Aggregating strategies", COLT 1990, with a power of
/// the mean in place of the exponential, so that no unit enters; the bank was chosen on traces of
/// random_motion, fast_bursts and door_opening.
/// Errors: SettingError if a list has neither one value nor one per channel.
struct GAUNTLET_API AdaptivePredictionConfig {
  static constexpr std::string_view kKind = "adaptive";
  static constexpr std::string_view kSummary =
      "a mixture of Kalman filters by how well each has predicted of late";

  std::vector<double> horizon_ms = {45.0};  // the paper's bound of the event time
  std::vector<double> r_deg2 = {0.5};
  double memory_ms = 1000.0;

  void Visit(SettingsVisitor& visitor);
};

/// Names of the filters of the bank, in their order.
inline constexpr std::string_view kPredictionBank[] = {"rest",       "free",       "swing_0.5_hz",
                                                       "swing_1_hz", "swing_2_hz", "swing_3_hz"};

}  // namespace gauntlet::controller
