#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim/answers/compare/summary.h"
#include "sim/score/latency.h"
#include "sim/trial/joint_angles.h"

namespace gauntlet::sim {

class Json;

/// Content of the page from the traces of the first seed; empty if none were kept, and then it has
/// neither curves nor latencies. Of a signal only its curves are kept, which are short however long
/// the trial is.
struct FirstSeed {
  FirstSeed() = default;
  /// With the reference, and curves for so many controllers.
  FirstSeed(const Signal& reference_rad, std::size_t controllers);
  /// The next controller. All angles are those of the measured joints, ticks x joints [rad].
  void Add(const WayOfAngles& way, const Signal& hand_rad);

  /// One curve per joint: see EncodeCurve().
  using Curves = std::vector<std::string>;
  struct ControllerCurves {
    Curves hand;
    Curves filtered;
    Curves command;
  };

  std::int64_t samples = 0;
  int samples_per_bucket = 1;
  Curves reference;
  Curves raw;  // before its filter every controller sees the same
  std::vector<ControllerCurves> controllers;
  std::vector<std::optional<LatencyBudget>> latency;  // as LatencyOfTrace() gives them
  std::optional<CountedParts> counted;                // none: all
};

/// Everything that the scripts of a report page show, besides the settings: scores of controllers,
/// joints, motors and cables with intervals, ranks and marks, and latencies and curves of the first
/// seed.
Json PageData(const FinishedStudy& finished, const FirstSeed& first_seed);

}  // namespace gauntlet::sim
