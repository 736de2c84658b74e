#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/fit/answering_servo.h"
#include "sim/fit/chain_log.h"
#include "sim/hand/hand_model.h"

namespace gauntlet::sim {

/// The servo of kind ideal that explains a log, from the equations of the model without a trial.
/// None if no part of the log has a model.
///
/// Such a servo is a chain of ServoInput, Servo and Spool: dead time, dry friction f against the
/// servo's gain K, and
///
///     J z'' = K (q - z) - K damping z'
///
/// So dead_time_ms and damping_ms are the fitted dead time and lag, full_torque_error_deg is
/// inertia_s2 stall / J, and f is K times half the width of the loop at the spool. J is the inertia
/// of the model's spools times the inertia_scale of the usual servo, so that torques are usual; the
/// fingers' inertia is neglected. no_load_speed_deg_s is the speed limit, if most parts have one.
/// All values are medians over the half of the parts with the best-known lag, because the hand has
/// one servo for all motors. Motors of arm_servo are left out. A first-order lag becomes a
/// second-order lag with a damping ratio of 1.5.
std::optional<AnsweringServo> UntriedServo(const ChainLog& log, const std::vector<ChainFit>& fits,
                                           const HandModel& hand);

/// The part of a scenario (`hand:` and `event:`) with which the simulated hand answers commands
/// like the hand of a log, with comments. TryServos() refines it if parts of the log are joints of
/// the simulated hand, and reports its `progress`. Empty if no part of the log has a model.
std::string ServoSettingsText(const ChainLog& log, const HandModel& hand,
                              const ChainProgress& progress = {});

}  // namespace gauntlet::sim
