#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "controller/joint_map.h"
#include "sim/study/study.h"

namespace gauntlet::sim {

/// Time that filters and hand need to recover after a gap: `score.recovery_s`.
int RecoveryTicks(const Scenario& scenario, double tick_rate_hz);

/// The ticks of a trial that count, for each of some joints of the hand. A joint follows the
/// channels that move it.
std::vector<CountedTicks> CountedTicksOfJoints(std::span<const int> joints,
                                               const controller::JointMap& joint_map,
                                               std::span<const MaskedStretch> masked,
                                               int recovery_ticks, int ticks);

/// The ticks of a trial that count, for every measured part; nothing if all do. A motor
/// and its cables follow the channels of all joints that it turns, the hand as a whole all of them.
std::optional<CountedParts> CountedPartsOf(const Study& study,
                                           std::span<const MaskedStretch> masked, int ticks);

/// Per measured joint the share of the time that counts, over all repetitions.
std::vector<double> CountedShares(const Study& study);

/// One line for the user about the time that the scores leave out, and the reason. Empty if all
/// time counts.
/// Errors: SettingError of `glove.motion` if less than 20 % counts, as a mean over the joints.
std::string CountedRemark(const Study& study);

}  // namespace gauntlet::sim
