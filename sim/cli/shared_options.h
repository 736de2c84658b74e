#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sim/cli/command.h"
#include "sim/results/table_text.h"

namespace gauntlet::sim {

/// Check of an option whose value is a path: an unset variable of a shell is empty.
std::string ProblemOfPath(const std::string& path);

/// An argument that has to be given.
Option Argument(std::string name, std::string* variable, Offer offer, std::string help);
/// A file, or the name of a ready scenario. It becomes what ScenarioFile() returns.
Option ScenarioArgument(std::string& file);
/// The file that a user means: one that is there, or a ready scenario, also by its name alone.
/// Errors: UserError for a name that no scenario has.
std::string ScenarioFile(const std::string& given);
/// Changes values of a scenario.
Option SetOption(std::vector<std::string>& overrides, const std::string& help);
/// Only these of the scenario.
Option ControllersOption(std::vector<std::string>& names);
/// How many trials run at a time; 0, its default, is one per core.
Option JobsOption(int& jobs);
/// The consent that trials run the programs that the scenario names: see AllowPrograms().
Option AllowProgramsOption(bool& allow);
/// A folder, or a file: `value` is its name in --help. An empty `out` has no default there: the
/// command has a place of its own. An empty path that is given is a mistake.
Option OutOption(std::string& out, const std::string& help, const std::string& value = "DIR");
/// Consent of a command to replace files that people edit.
Option ForceOption(bool& force);
/// Part of a recording that a command reads: an array or a topic.
Options ArrayOptions(std::string& array);
/// Two topics of a log: the commands, and the measured states.
Options TopicPairOptions(std::string& command, std::string& state);

/// --time-unit, for a column of numbers that is the time.
Option TimeUnitOption(std::string& unit, std::vector<std::string> excludes = {});
/// --unit, of columns whose names have none: one of `units`.
Option UnitOption(std::string& unit, std::vector<std::string> units, const std::string& help,
                  std::vector<std::string> excludes = {});

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

/// The program of this name in the first folder of PATH that has it.
std::optional<std::filesystem::path> FindProgram(const std::string& name);

/// Prints a text four columns to the right: at a terminal in lines that fit, else in one line, for
/// those who search.
void PrintIndented(const std::string& text);

/// Style of standard output. Its width is that of the variable COLUMNS, else the terminal's, else
/// 80; `auto` colours a terminal where NO_COLOR is not set (https://no-color.org).
TerminalStyle StyleOf(const TerminalOptions& options);

}  // namespace gauntlet::sim
