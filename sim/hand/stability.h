#pragma once

#include <vector>

#include "sim/hand/drive.h"

namespace gauntlet::sim {

/// Forces of servos and cables are those of the time step's beginning. An oscillator of stiffness
/// k, damping c and inertia I stays stable at a step h if
///
///     (2 c h + k h^2) / I < 4
///
/// with cables as taut as they can be and, with friction, held fast where they bend, which leaves
/// each end half of the cable.
///
/// Gives joints whose inertia is less than 2 c h + k h^2 the rest of it, the others free to give
/// way (inverse inertia at the model's zero posture); k and c of a cable that passes several joints
/// count for all of them together. It falls with h^2 and h, and with it what it changes: fingers
/// are lighter than a step of 1 ms can bear.
void GiveLightJointsInertia(mjModel_& model, const std::vector<Drive>& drives);

/// Adds to the inertia of a rotor on a joint, also where the engine has its inertia as a constant.
void AddArmature(mjModel_& model, int dof, double inertia_kg_m2);

/// Refuses servos that the time step cannot bear on their spools, by the same law.
/// Errors: UserError with the keys to change.
void CheckStability(const mjModel_& model, const std::vector<Drive>& drives);

}  // namespace gauntlet::sim
