#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace gauntlet::sim {

/// `--out`: where a command writes. Left out, it is empty and the command has a place of its own;
/// an empty one that is given is a mistake.
CLI::Option* AddOutOption(CLI::App& command, std::string& out, const std::string& help,
                          const std::string& type_name);

/// --force, of a command that writes files that people edit.
void AddForceOption(CLI::App& command, bool& force);

}  // namespace gauntlet::sim
