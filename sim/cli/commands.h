#pragma once

#include <CLI/CLI.hpp>

namespace gauntlet::sim {

// Each adds its subcommand with options and help; CLI11 runs it after parsing. Errors travel as
// exceptions to main(), the only place that knows exit codes; a result that is not an error but has
// an exit code travels as CLI::RuntimeError.
void AddRunCommand(CLI::App& app);
void AddCompareCommand(CLI::App& app);
void AddSweepCommand(CLI::App& app);
void AddTuneCommand(CLI::App& app);
void AddRobustCommand(CLI::App& app);
void AddRenderCommand(CLI::App& app);
void AddExportCommand(CLI::App& app);
void AddDiffCommand(CLI::App& app);
void AddReproduceCommand(CLI::App& app);
void AddListCommand(CLI::App& app);
void AddFilterCommand(CLI::App& app);
void AddCalibrateCommand(CLI::App& app);
void AddIdentifyCommand(CLI::App& app);
void AddInspectCommand(CLI::App& app);

}  // namespace gauntlet::sim
