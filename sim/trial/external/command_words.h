#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "controller/filters/external_filter.h"

namespace gauntlet::sim {

/// The words of a command: blanks separate them; 'single' and "double" quotes keep blanks, and
/// nothing else has a meaning. No shell reads it.
/// Errors: SettingError `command` for a quote that does not end, or no word.
std::vector<std::string> CommandWords(const std::string& command);

/// The folder of the settings, absolute. Errors: SettingError `folder` for one that is not there.
std::filesystem::path FolderOf(const controller::ExternalConfig& config);

/// A command that can be started.
struct ProgramCommand {
  std::vector<std::string> words;
  std::filesystem::path program;  // absolute: the first word, looked for as a shell does
  std::filesystem::path folder;   // absolute: where it runs
};
/// Errors: SettingError `command` or `folder` for a program or a folder that is not there.
ProgramCommand FindProgram(const controller::ExternalConfig& config);

/// The files that decide what the program does: itself, and those of its words that are files.
std::vector<std::filesystem::path> FilesOf(const ProgramCommand& command);

}  // namespace gauntlet::sim
