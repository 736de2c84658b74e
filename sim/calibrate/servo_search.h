#pragma once

#include <optional>
#include <vector>

#include "sim/calibrate/answering_servo.h"
#include "sim/calibrate/chain_log.h"
#include "sim/hand/hand_config.h"

namespace gauntlet::sim {

/// Finds the servo with which the angles of the simulated hand are nearest to those of logs, by
///
///     miss^2 = mean over logs and parts of (mean square of measured less simulated / of the motion)
///
/// behind the first 0.5 s, with the median delay of the logs: dead time only shifts the answer of a servo
/// of kind ideal, so it follows from the delay of an answer without it. What dead time cannot reach
/// adds to the miss. A grid over the ranges of the other settings, damping, gain and friction, is
/// simulated unless `start` already misses less than 5 % of the motion. Then a pattern search
/// begins at the best point, with steps that are halved. Both are deterministic, and at most 82
/// answers of the first log are simulated, those of the grid up to 6 s, and 48 of all logs.
///
/// Friction is one factor on the scales of all motors of `start`. All logs have the same parts.
/// None if no part of the log is a joint of the model, no such hand can be simulated, or the best
/// one misses as much as a hand at rest.
std::optional<AnsweringServo> SearchServo(const std::vector<ChainLog>& logs,
                                          const AnsweringServo& start, const HandConfig& usual);

}  // namespace gauntlet::sim
