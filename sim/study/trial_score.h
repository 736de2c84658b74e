#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "sim/study/study.h"

namespace gauntlet::sim {

/// The signals of a trace that these scores are made of, its twin included; no metrics are all.
std::vector<std::string_view> SignalsOfScores(std::span<const std::size_t> metrics);

/// The scores of one trial of the study, of the parts of the hand that count. `reference_rad` are
/// the true angles as the hand's joints have them [ticks x joints]; `twin` is the same trial
/// without noise, if there is one, and `others` those without causes of the error: see ScoreInput.
/// `metrics`: as of ComputeScores(). A signal that was not recorded is missing there, too. Ticks
/// `left_out` do not count, but in the share of saturation.
Scores ScoreTrial(const Study& study, const controller::ControllerConfig& controller,
                  const GloveSignal& glove, const Signal& reference_rad, const Trace& trace,
                  const std::optional<NoiseFreeTwin>& twin,
                  std::span<const std::size_t> metrics = {}, const CauseAngles& others = {},
                  std::span<const TickRange> left_out = {});

}  // namespace gauntlet::sim
