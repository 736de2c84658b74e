#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "controller/joint_map.h"
#include "sim/study/study.h"

namespace gauntlet::sim {

/// How long filters and hand need to come back after a gap, by `score.recovery_s`.
int RecoveryTicks(const Scenario& scenario, double tick_rate_hz);

/// Which ticks of a trial of `ticks` count, of each of some joints of the hand. A joint follows the
/// channels that move it.
std::vector<CountedTicks> CountedTicksOfJoints(std::span<const int> joints,
                                               const controller::JointMap& joint_map,
                                               std::span<const MaskedStretch> masked,
                                               int recovery_ticks, int ticks);

/// Which ticks of a trial of `ticks` count, of every measured part; nothing where all do. A motor
/// and its cables follow the channels of all joints that it turns, the hand as a whole all of them.
std::optional<CountedParts> CountedPartsOf(const Study& study,
                                           std::span<const MaskedStretch> masked, int ticks);

/// Per measured joint the share of the time that counts, over all repetitions.
std::vector<double> CountedShares(const Study& study);

/// What is left out of the scores and why, in one line; empty where all counts.
std::string CountedRemark(const Study& study);

}  // namespace gauntlet::sim
