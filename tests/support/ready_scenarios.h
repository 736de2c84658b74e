#pragma once

#include <algorithm>
#include <filesystem>
#include <vector>

#include "tests/support/source_dir.h"

namespace gauntlet {

/// All scenarios that are shipped, by name.
inline std::vector<std::filesystem::path> ReadyScenarios() {
  std::vector<std::filesystem::path> files;
  const std::filesystem::path folder = std::filesystem::path(SourceDir()) / "scenarios";
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".yaml") files.push_back(entry.path());
  }
  std::ranges::sort(files);
  return files;
}

}  // namespace gauntlet
