#pragma once

#include <span>

#include "sim/score/mean_square_error.h"
#include "sim/score/score.h"

namespace gauntlet::sim {

/// Whether all of these metrics are made of the MeanSquareError alone, so that a trial need not
/// keep its signals for them.
bool AreInPassing(std::span<const std::size_t> metrics);

/// Such scores of a trial, with the same bits as ComputeScores() gives for its signals. The error
/// is that of the joints of `rows`. Errors: std::invalid_argument for other metrics or other joints
/// (the caller's mistake).
Scores ScoresInPassing(const MeanSquareError& error, const ScoreRows& rows,
                       std::span<const std::size_t> metrics);

}  // namespace gauntlet::sim
