#pragma once

#include "sim/calibrate/chain_log.h"
#include "sim/hand/hand_config.h"

namespace gauntlet::sim {

/// No more of a log is given to the simulated hand, and no more rows of its answer are kept.
inline constexpr double kLongestAnswer_s = 30.0;
inline constexpr double kMostAnswerRows_hz = 250.0;

/// What the simulated hand does when it is told what the log's hand was told: commands in frames as
/// a scenario sends them, without a delay of the link; between the log's rows straight lines, or
/// a held command.
///
/// The motors' angles are where the spools put the joints if cables neither stretch nor go slack.
/// Only parts that are joints of the model with a motor of `hand.servo` are in the answer; its
/// other joints stand in the middle of their ranges. Rows are about as far apart as the log's.
/// Without rows: no part is such a joint, or the hand was stopped.
/// Errors: UserError for a hand that cannot be built.
ChainLog SimulatedAnswer(const ChainLog& log, const HandConfig& hand);

}  // namespace gauntlet::sim
