#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/calibrate/answering_servo.h"
#include "sim/calibrate/chain_log.h"
#include "sim/hand/hand_model.h"

namespace gauntlet::sim {

/// The servo of kind ideal that a log asks for, from the equations of the model alone; none if no
/// part of the log has a model.
///
/// Such a servo is a chain of ServoInput, Servo and Spool: dead time, dry friction f against the
/// servo's gain K, and J z'' = K (q - z) - K damping z'. So dead_time_ms and damping_ms are dead
/// time and lag as they are, full_torque_error_deg is inertia_s2 stall / J, and f is K times half
/// the width of the loop at the spool. J is that of the model's spools times the inertia_scale of
/// the usual servo, so that torques are usual ones; what fingers add to it is left out. All are
/// medians over the half of the parts whose lag the log tells best, as the hand has one servo for
/// all its motors; those that arm_servo turns are left out. A lag of first order becomes one with a
/// damping ratio of 1.5.
std::optional<AnsweringServo> UntriedServo(const ChainLog& log, const std::vector<ChainFit>& fits,
                                           const HandModel& hand);

/// The part of a scenario (`hand:` and `event:`) with which the simulated hand answers commands as
/// the hand of a log does, by TryServos() where its parts are joints of the simulated hand, its
/// comments included; empty if no part of the log has a model.
std::string ServoSettingsText(const ChainLog& log, const std::vector<ChainFit>& fits,
                              const HandModel& hand);

}  // namespace gauntlet::sim
