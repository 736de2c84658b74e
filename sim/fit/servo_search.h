#pragma once

#include <optional>
#include <vector>

#include "sim/fit/answering_servo.h"
#include "sim/fit/chain_log.h"
#include "sim/hand/hand_config.h"

namespace gauntlet::sim {

/// Finds the servo with which the angles of the simulated hand are nearest to those of logs, by
///
///     miss^2 = mean over logs and parts of mean square of (measured less simulated)
///              / mean square of the motion
///
/// behind the first 0.5 s, with the median delay of the logs. Dead time only shifts the answer of a
/// servo of kind ideal, so it follows from the delay of an answer without it; a delay out of its
/// reach adds to the miss. `start` is returned if it misses less than 5 % of the motion, with that
/// delay within 10 ms. Else the ranges of damping, gain and friction are searched on the first 6 s
/// of the first log, by 80 answers, then around the best by 40 answers of all logs (optimise.h).
///
/// Friction is one factor on the scales of all motors of `start`. All logs have the same parts.
/// None if no part of the log is a joint of the model, no such hand can be simulated, or the best
/// one misses as much as a hand at rest.
std::optional<AnsweringServo> SearchServo(const std::vector<ChainLog>& logs,
                                          const AnsweringServo& start, const HandConfig& usual);

}  // namespace gauntlet::sim
