#pragma once

#include <string>
#include <vector>

#include "sim/settings/yaml_tree.h"
#include "sim/study/scenario/scenario.h"

namespace gauntlet::sim {

/// Place of a `prediction.horizon_ms: auto` in a scenario.
struct AutoHorizon {
  std::string controller;
  YamlNode node;
};

/// Takes `prediction.horizon_ms: auto` out of the tree: it means what leaving it out does, and that
/// there must be a chain.
std::vector<AutoHorizon> TakeAutoHorizons(YamlNode& root);

/// Gives the controllers of a scenario what its tree leaves out and something else says: the file
/// of a calibration the linearisation and r, that of a chain the horizon of a prediction, the
/// scenario's own noise the r of a glove that is not the paper's. A controller's own keys win.
/// Errors: UserError for a file that cannot be read or is of other channels, `auto` without a
/// chain, and an r that nothing gives.
void FillControllers(const YamlNode& root, const YamlSource& source,
                     const std::vector<AutoHorizon>& auto_horizons, Scenario& scenario);

}  // namespace gauntlet::sim
