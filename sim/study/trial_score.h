#pragma once

#include <optional>
#include <span>

#include "sim/study/study.h"

namespace gauntlet::sim {

/// The scores of one trial of the study, of the parts of the hand that count. `reference_rad` are
/// the true angles as the hand's joints have them [ticks x joints]; `twin` is the same trial
/// without noise, if there is one: see ScoreInput. `metrics`: as of ComputeScores().
Scores ScoreTrial(const Study& study, const GloveSignal& glove, const Signal& reference_rad,
                  const Trace& trace, const std::optional<NoiseFreeTwin>& twin,
                  std::span<const std::size_t> metrics = {});

}  // namespace gauntlet::sim
