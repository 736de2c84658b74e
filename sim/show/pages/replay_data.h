#pragma once

#include <string>

#include "sim/answers/compare/summary.h"
#include "sim/hand/hand_model.h"

namespace gauntlet::sim {

class Json;

/// Shapes, hinges and cables of a hand, and a camera of the model: what hand_scene.js draws.
/// Lengths in m, angles in deg.
Json HandData(const HandModel& hand, const std::string& camera);

/// Data for moving the hand of a page, besides its curves: the hand's shapes, hinges and cables,
/// where joints stand that are not measured (their mean, as they only hold a posture), and the way
/// of an object. Lengths in m, angles in deg. Null where there is no hand or no trace was kept.
Json ReplayData(const FinishedStudy& finished);

}  // namespace gauntlet::sim
