#pragma once

#include <optional>

#include "controller/controller_config.h"
#include "sim/hand/hand_model.h"
#include "sim/score/latency.h"
#include "sim/trial/joint_angles.h"

namespace gauntlet::sim {

/// The hand cannot be late by less: the delay of the link to the hand, less the horizon of the
/// controller's prediction. 0 for planned commands, which meet the wearer but do not lead.
double EarliestDelay_s(const HandModel& hand, const controller::ControllerConfig& controller);

/// Parts of the delay of one trial, stage by stage. None where there is nothing to measure: a
/// wearer who did not move, or a hand that was stopped within two seconds. All angles are those of
/// the same joints, ticks x joints [rad]; `counted` has what counts of each, all if there is none.
std::optional<LatencyBudget> LatencyOfTrace(const HandModel& hand,
                                            const controller::ControllerConfig& controller,
                                            const Signal& reference_rad, const WayOfAngles& way,
                                            const Signal& hand_angle_rad,
                                            const std::optional<CountedParts>& counted);

}  // namespace gauntlet::sim
