#pragma once

#include "sim/fit/chain_log.h"
#include "sim/hand/hand_config.h"

namespace gauntlet::sim {

/// Longest part of a log that is simulated, and highest rate of the answer's rows.
inline constexpr double kLongestAnswer_s = 30.0;
inline constexpr double kMostAnswerRows_hz = 250.0;
/// Beginning of an answer that is not compared with the log, because the hand's state is unknown.
inline constexpr double kNotCompared_s = 0.5;

/// Answer of the simulated hand to the commands of a log. Commands are sent in frames as in a
/// scenario, without delay of the link. Between the log's rows a command is interpolated linearly
/// or held.
///
/// The motors' angles are the joint angles for their spools, with cables that neither stretch nor
/// go slack. The answer contains the parts that are joints of the model with a motor of
/// `hand.servo`. The model's other joints stay in the middle of their ranges. The row distance is
/// about that of the log. No rows: no part is such a joint, or the hand was stopped.
/// Errors: UserError for a hand that cannot be built.
ChainLog SimulatedAnswer(const ChainLog& log, const HandConfig& hand);

}  // namespace gauntlet::sim
