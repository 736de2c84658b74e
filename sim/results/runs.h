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
  std::string answer;        // second paragraph
  std::string written;       // 2026-11-29 16:41, local time of the answer
  std::uintmax_t bytes = 0;  // of all files in it
};

/// All below `root`, at most three folders deep, the newest first; folders that cannot be read are
/// left out.
std::vector<Run> FindRuns(const std::filesystem::path& root);

/// 43.5 MB
std::string SizeText(std::uintmax_t bytes);

}  // namespace gauntlet::sim
