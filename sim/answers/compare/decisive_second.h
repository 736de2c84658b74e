#pragma once

#include <optional>

#include "sim/answers/compare/summary.h"

namespace gauntlet::sim {

/// Second in which the hands of a comparison differ most. Units: s from the begin of the motion.
struct DecisiveSecond {
  double from_s = 0.0;
  double to_s = 0.0;
  double moment_s = 0.0;  // within, where the difference is largest
};

/// Second of the first seed with the largest difference between the hand of the first of
/// ComparisonAnswer::shown and those of the others:
///
///     difference(t) = sum over others of (mean over measured joints of (other(t) - first(t))^2)
///
/// The second with the largest mean of it, in steps of 0.05 s. None for fewer than two hands.
std::optional<DecisiveSecond> DecisiveSecondOf(const FinishedStudy& finished);

}  // namespace gauntlet::sim
