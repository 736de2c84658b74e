#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace gauntlet::sim {

struct RenderOptions {
  std::filesystem::path folder;          // of a finished run or comparison
  std::vector<std::string> controllers;  // empty: all
  std::filesystem::path target;          // empty: VideoOf(folder)
  int jobs = 1;
};

/// Where `folder` has its video.
std::filesystem::path VideoOf(const std::filesystem::path& folder);

/// What can be known of a video before the motion that it shows: more controllers than it has room
/// for, or a folder in its place. Sizes and camera are checked with the scenario. Errors:
/// UserError.
void CheckVideo(int controllers, const std::filesystem::path& target);

/// Draws the comparison video from `trace.h5` and `scenario.resolved.yaml`, checked by the
/// manifest. Returns the file.
/// `keep_going` gets frames done and in all; false stops by a Cancelled exception.
/// Errors: UserError for a folder without them, RunError for a video that cannot be written.
std::filesystem::path RenderFolder(const RenderOptions& options,
                                   const std::function<bool(int, int)>& keep_going = {});

}  // namespace gauntlet::sim
