#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace gauntlet::sim {

/// A finished output folder, as a person looks for it.
struct Run {
  std::filesystem::path folder;
  std::string question;      // of its answer, or the first paragraph of it
  std::string choices;       // see ChoicesText()
  std::string answer;        // second paragraph, or its first sentences
  std::string written;       // 2026-11-29 16:41, local time of the answer
  std::uintmax_t bytes = 0;  // of all files in it
};

/// All below `root`, at most three folders deep, the newest first; folders that cannot be read are
/// left out.
std::vector<Run> FindRuns(const std::filesystem::path& root);

/// Lines of a list below the folder: question, choices, answer, date and size.
std::vector<std::string> LinesOf(const Run& run);

/// Options that change a scenario.
struct Choices {
  std::vector<std::string> set = {};
  std::vector<std::string> added = {};
  std::vector<std::string> controllers = {};
  std::string priority = {};
};
/// Words of a command line, for OutputPlan: "--set event.delay_ms=50". Empty where the
/// scenario is as its file.
std::string ChoicesText(const Choices& choices);

/// 43.5 MB
std::string SizeText(std::uintmax_t bytes);

}  // namespace gauntlet::sim
