#include "sim/show/video/video_encoder.h"

#include "sim/show/video/drawing_library.h"

namespace gauntlet::sim {

Container ContainerOf(const std::filesystem::path& file) {
  if (file.extension() == ".gif") return Container::kGif;
  return file.extension() == ".webm" ? Container::kWebm : Container::kMp4;
}

std::unique_ptr<VideoEncoder> OpenVideo(const OutputFile& file, const VideoFormat& format) {
  return LoadDrawingLibrary().open_encoder(file, format);
}

}  // namespace gauntlet::sim
