#pragma once

#include <string>

#include "sim/answers/compare/prediction_ceiling.h"

namespace gauntlet::sim {

/// How far a prediction looks ahead and how much of what is predictable it uses, in a sentence.
std::string PredictionText(const PredictionCeiling& ceiling);

}  // namespace gauntlet::sim
