#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "sim/show/video/frame_clock.h"
#include "sim/show/video/look.h"
#include "sim/show/video/video_encoder.h"
#include "sim/study/scenario/scenario.h"

namespace gauntlet::sim {

struct RenderOptions {
  std::filesystem::path folder;            // of a finished run or comparison
  std::vector<std::string> controllers{};  // panes in this order; empty: those of the verdict
  bool overlay = false;  // two controllers in one picture, in the order of `controllers`
  std::vector<std::string> overrides{};  // of the scenario, as video.camera=arm
  Excerpt excerpt{};
  Look look = kGoodLook;
  int rate_factor = VideoFormat{}.rate_factor;
  std::optional<double> frame_s{};  // a picture of this moment and no video
  std::filesystem::path target{};   // empty: VideoOf(folder) or PictureOf(folder)
  int jobs = 1;
};

/// Places in `folder` of its video and of a picture of one moment of it.
std::filesystem::path VideoOf(const std::filesystem::path& folder);
std::filesystem::path PictureOf(const std::filesystem::path& folder);
/// Place of the picture that a page shows before its video plays.
std::filesystem::path PosterOf(const std::filesystem::path& folder);

/// Checks of a video all that can be known before the motion is drawn: that no folder is in its
/// place. Sizes and camera are checked with the scenario. Errors: UserError.
void CheckVideoTarget(const std::filesystem::path& target);

/// Draws the comparison video or one frame of it from `trace.h5` and `scenario.resolved.yaml`,
/// checked by the manifest. Beside the video of a page it draws the poster, too: the middle of the
/// part that is shown in slow motion. Returns the file.
/// `keep_going` gets frames done and in all; false stops by a Cancelled exception.
/// Errors: UserError for a folder without them, RunError for a video that cannot be written.
std::filesystem::path RenderFolder(const RenderOptions& options,
                                   const std::function<bool(int, int)>& keep_going = {});

}  // namespace gauntlet::sim
