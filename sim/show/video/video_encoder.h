#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "sim/base/output_file.h"
#include "sim/show/video/image.h"

namespace gauntlet::sim {

enum class Container { kMp4, kWebm, kGif };
/// By the ending of the file's name: .webm, .gif, or anything else.
inline Container ContainerOf(const std::filesystem::path& file) {
  if (file.extension() == ".gif") return Container::kGif;
  return file.extension() == ".webm" ? Container::kWebm : Container::kMp4;
}

/// A part of a video that players can jump to: frames [begin, end).
struct Chapter {
  std::string title;
  int begin = 0;
  int end = 0;
};

struct VideoFormat {
  int width_px = 1280;  // even: two neighbours share their colour
  int height_px = 720;  // even
  int frames_per_s = 30;
  Container container = Container::kMp4;
  std::string encoder{};  // as libav calls it; empty: libx264, libvpx-vp9 or gif
  std::string preset = "veryfast";
  /// The encoder's constant rate factor: lower is better; 20 keeps thin curves and text crisp.
  int rate_factor = 20;
  /// In their order. In MP4 the first begins with the video, and one lasts until the next begins; a
  /// GIF has none.
  std::vector<Chapter> chapters{};
  /// Pictures whose colours the palette of a GIF has; without any, those of its first frame.
  std::vector<ImageView> samples{};
};

/// An MP4 file with H.264, or a WebM file with VP9; yuv420p in BT.709; the index of MP4 in front:
/// plays while it loads, in every browser. Or a GIF, which plays where no video does: of 255
/// colours of its own without dithering, and at most 50 frames per second, as browsers show no
/// more.
///
/// Frame by frame, so memory does not grow with the length; frame k is shown at exactly
/// k / frames_per_s. After Finish() the file is whole, and can be committed by its owner.
/// Same frames, same bytes, on any number of cores.
class VideoEncoder {
 public:
  virtual ~VideoEncoder() = default;
  /// The next frame. Alpha is not looked at. Errors: RunError for a full disk.
  virtual void Add(ImageView frame) = 0;
  virtual void Finish() = 0;
};

/// `file` must outlive the encoder.
/// Errors: UserError for a size or rate that the file cannot have; RunError for a missing encoder
/// (before anything is written), a missing folder, a full disk.
std::unique_ptr<VideoEncoder> OpenVideo(const OutputFile& file, const VideoFormat& format);

}  // namespace gauntlet::sim
