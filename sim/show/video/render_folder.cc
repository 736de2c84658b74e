#include "sim/show/video/render_folder.h"

#include "sim/base/error.h"
#include "sim/show/video/comparison_video.h"
#include "sim/show/video/folder_video.h"

namespace gauntlet::sim {
std::filesystem::path VideoOf(const std::filesystem::path& folder) {
  return folder / "comparison.mp4";
}

std::filesystem::path PictureOf(const std::filesystem::path& folder) {
  return folder / "comparison.png";
}

std::filesystem::path PosterOf(const std::filesystem::path& folder) {
  return folder / "poster.png";
}

void CheckVideoTarget(const std::filesystem::path& target) {
  std::error_code ignored;
  if (!std::filesystem::is_directory(target, ignored)) return;
  throw UserError({.place = target.string(), .problem = "is a folder, must be a file"});
}

std::filesystem::path RenderFolder(const RenderOptions& options,
                                   const std::function<bool(int, int)>& keep_going) {
  std::filesystem::path target = options.target;
  if (target.empty()) {
    target = options.frame_s ? PictureOf(options.folder) : VideoOf(options.folder);
  }
  CheckVideoTarget(target);
  const FolderVideo video(options, [&] { return !keep_going || keep_going(0, 1); });
  if (options.frame_s) {
    WriteComparisonPng(video.input(), video.hand(), *options.frame_s, target);
  } else {
    WriteComparisonVideo(video.input(), video.hand(), target, keep_going);
    const std::optional<Excerpt>& again = video.input().again;
    if (again && target == VideoOf(options.folder)) {
      WriteComparisonPng(video.input(), video.hand(), 0.5 * (again->from_s + again->to_s),
                         PosterOf(options.folder));
    }
  }
  return target;
}

}  // namespace gauntlet::sim
