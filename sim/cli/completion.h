#pragma once

#include <string>
#include <vector>

#include "sim/cli/command.h"

namespace gauntlet::sim {

/// Offers of a shell for the last of `words`, which are those behind the program's name: what
/// --help knows, names of scenarios and of their controllers, keys for --set. A line each, with a
/// tabulator and its meaning behind it where there is one. `:files` and `:folders` ask the shell
/// for those, too; `:open` means that the word goes on behind what is offered. Never fails: where
/// nothing is known, nothing is offered.
std::string Completions(const std::vector<Command>& commands,
                        const std::vector<std::string>& words);

}  // namespace gauntlet::sim
