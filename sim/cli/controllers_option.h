#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace gauntlet::sim {

/// `--controllers a,b`: only these of the scenario.
void AddControllersOption(CLI::App& command, std::vector<std::string>& names);

}  // namespace gauntlet::sim
