#pragma once

#include <string>

#include "sim/study/study.h"

namespace gauntlet::sim {

// What decides a trial: its study, its controller's settings and its seed. Two trials that agree in
// all three give the same bytes.

/// What all trials of a study share, whatever their seed, as a scenario's YAML.
std::string SharedSettings(const Study& study);

/// Of glove, hand, event, the model, the glove signals of the first seed of every repetition and
/// the program itself: another build may compute other bytes.
std::string HashOfStudy(const Study& study);

/// Of all that the controller is made from, its name included.
std::string HashOfSettings(const NamedController& controller);

}  // namespace gauntlet::sim
