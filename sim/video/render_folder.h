#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace gauntlet::sim {

struct RenderOptions {
  std::filesystem::path folder;          // of a finished run or comparison
  std::vector<std::string> controllers;  // empty: all
  std::filesystem::path target;          // empty: comparison.mp4 in the folder
  int jobs = 1;
};

/// Draws the comparison video from `trace.h5` and `scenario.resolved.yaml`, checked by the manifest.
/// Returns the file.
/// `keep_going` gets frames done and in all; false stops by a Cancelled exception.
/// Errors: UserError for a folder without them, RunError for a video that cannot be written.
std::filesystem::path RenderFolder(const RenderOptions& options,
                                   const std::function<bool(int, int)>& keep_going = {});

}  // namespace gauntlet::sim
