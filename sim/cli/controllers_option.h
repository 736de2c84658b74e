#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "sim/scenario/scenario.h"

namespace gauntlet::sim {

/// `--controllers a,b`: only these of the scenario.
void AddControllersOption(CLI::App& command, std::vector<std::string>& names);

/// Errors: UserError for a name that the scenario does not have, or that is given twice.
void CheckControllersOption(const std::vector<std::string>& names, const Scenario& scenario);

}  // namespace gauntlet::sim
