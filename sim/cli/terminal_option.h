#pragma once

#include <string>

#include "sim/cli/command.h"
#include "sim/results/table_text.h"

namespace gauntlet::sim {

/// How tables are printed, as asked for.
struct TerminalOptions {
  std::string colour = "auto";
  bool wide = false;

  /// --color and --wide.
  Options Rows() {
    return {
        Option("--color", &colour, {.choices = {"auto", "always", "never"}},
               "colours; auto: in a terminal unless NO_COLOR is set [auto]"),
        Option("--wide", &wide, {}, "do not split wide tables"),
    };
  }
};

inline Option VerboseOption(
    bool& verbose,
    const char* help = "also print confidence intervals, all main scores and methods") {
  return Option("--verbose", &verbose, {}, help);
}

/// Style of standard output. Its width is that of the variable COLUMNS, else the terminal's, else
/// 80; `auto` colours a terminal where NO_COLOR is not set (https://no-color.org).
TerminalStyle StyleOf(const TerminalOptions& options);

}  // namespace gauntlet::sim
