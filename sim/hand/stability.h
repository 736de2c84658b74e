#pragma once

#include <vector>

#include "sim/hand/drive.h"

namespace gauntlet::sim {

/// Refuses settings that the time step cannot bear. Forces of servos and cables are those of the
/// step's beginning; an oscillator of stiffness k, damping c and inertia I stays stable at step h
/// if
///
///     2 c h / I + k h^2 / I < 4
///
/// Checked for every spool and for every joint, cables as taut as they can be and, with friction,
/// held fast where they bend, which leaves each end half of the cable; the rest of the hand free to
/// give way (inverse inertia at the model's zero posture).
/// Errors: UserError with the key to change.
void CheckStability(const mjModel_& model, const std::vector<Drive>& drives);

}  // namespace gauntlet::sim
