#pragma once

#include <nlohmann/json.hpp>

#include "sim/comparison/summary.h"

namespace gauntlet::sim {

/// What the page needs, besides its curves, to move the hand: the hand's shapes, hinges and cables,
/// where joints stand that are not measured (their mean, as they only hold a posture), and the way
/// of an object. Lengths in m, angles in deg. Null where there is no hand or no trace was kept.
nlohmann::ordered_json ReplayData(const FinishedStudy& finished);

}  // namespace gauntlet::sim
