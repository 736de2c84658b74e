#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "sim/results/table_text.h"

namespace gauntlet::sim {

/// How tables are printed, as asked for.
struct TerminalOptions {
  std::string colour = "auto";
  bool wide = false;
};

/// --color.
void AddColourOption(CLI::App& command, TerminalOptions& options);

/// --color and --wide.
void AddTableOptions(CLI::App& command, TerminalOptions& options);

/// Of standard output. Its width is that of the variable COLUMNS, else the terminal's, else 80;
/// `auto` colours a terminal where NO_COLOR is not set (https://no-color.org).
TerminalStyle StyleOf(const TerminalOptions& options);

}  // namespace gauntlet::sim
