#pragma once

#include <CLI/CLI.hpp>

namespace gauntlet::sim {

/// `--jobs`: how many trials run at a time; 0, its default, is one per core.
void AddJobsOption(CLI::App& command, int& jobs);

int JobsOrCores(int jobs);

}  // namespace gauntlet::sim
