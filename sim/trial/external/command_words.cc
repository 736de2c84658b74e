#include "sim/trial/external/command_words.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <string_view>

#include "sim/base/text.h"

namespace gauntlet::sim {
namespace {

using controller::SettingError;
namespace fs = std::filesystem;

bool IsProgram(const fs::path& file) {
  std::error_code unreadable;
  return fs::is_regular_file(file, unreadable) && access(file.c_str(), X_OK) == 0;
}

/// A name without a slash is looked for in the folders of PATH.
fs::path ProgramOf(const std::string& word, const fs::path& folder) {
  if (word.find('/') != std::string::npos) {
    fs::path file = (folder / word).lexically_normal();
    if (IsProgram(file)) return file;
    throw SettingError("command",
                       fmt::format("{}: no program that can be run", Shown(file.string())));
  }
  const char* const variable = std::getenv("PATH");
  std::string_view path = variable == nullptr ? "" : variable;
  while (!path.empty()) {
    const std::size_t end = std::min(path.find(':'), path.size());
    fs::path file = fs::path(path.substr(0, end)) / word;
    if (file.is_absolute() && IsProgram(file)) return file;
    path.remove_prefix(std::min(end + 1, path.size()));
  }
  throw SettingError("command",
                     fmt::format("{}: no program of this name in the folders of PATH; one in its "
                                 "own folder is ./{}",
                                 Shown(word), Shown(word)));
}

}  // namespace

std::vector<std::string> CommandWords(const std::string& command) {
  std::vector<std::string> words;
  bool inside = false;  // a word
  char quote = '\0';
  for (const char character : command) {
    if (quote != '\0') {
      if (character == quote) {
        quote = '\0';
      } else {
        words.back() += character;
      }
      continue;
    }
    const bool is_blank = character == ' ' || character == '\t' || character == '\n';
    if (is_blank) {
      inside = false;
      continue;
    }
    if (!inside) words.emplace_back();
    inside = true;
    if (character == '"' || character == '\'') {
      quote = character;
    } else {
      words.back() += character;
    }
  }
  if (quote != '\0') {
    throw SettingError("command", fmt::format("has a quote {} that does not end", quote));
  }
  if (words.empty() || words[0].empty()) throw SettingError("command", "names no program");
  return words;
}

fs::path FolderOf(const controller::ExternalConfig& config) {
  std::error_code unreadable;
  fs::path place = (fs::current_path() / config.folder).lexically_normal();
  if (!fs::is_directory(place, unreadable)) {
    throw SettingError("folder", fmt::format("{}: no such folder", Shown(place.string())));
  }
  return place;
}

ProgramCommand FindProgram(const controller::ExternalConfig& config) {
  fs::path place = FolderOf(config);
  std::vector<std::string> words = CommandWords(config.command);
  fs::path program = ProgramOf(words[0], place);
  return {.words = std::move(words), .program = std::move(program), .folder = std::move(place)};
}

std::vector<fs::path> FilesOf(const ProgramCommand& command) {
  std::vector<fs::path> files = {command.program};
  for (std::size_t i = 1; i < command.words.size(); ++i) {
    const fs::path file = (command.folder / command.words[i]).lexically_normal();
    std::error_code unreadable;
    if (fs::is_regular_file(file, unreadable)) files.push_back(file);
  }
  return files;
}

}  // namespace gauntlet::sim
