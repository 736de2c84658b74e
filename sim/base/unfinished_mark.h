#pragma once

#include <filesystem>

namespace gauntlet::sim {

/// The file beside a recording that says that its session runs, or did not end.
inline std::filesystem::path UnfinishedMark(std::filesystem::path recording) {
  return recording += ".unfinished";
}

}  // namespace gauntlet::sim
