#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace gauntlet::sim {

/// What a player finds in a video file, by decoding all of it.
struct VideoContent {
  std::string codec;
  std::string pixel_format;
  std::string color_space;
  int width_px = 0;
  int height_px = 0;
  double frames_per_s = 0.0;
  int frames = 0;
  struct Chapter {
    std::string title;
    double begin_s = 0.0;
    double end_s = 0.0;
  };
  std::vector<Chapter> chapters{};
  bool times_are_even = true;  // frame k is shown at exactly k / frames_per_s
  /// Of each frame, the mean brightness in 0 .. 255 of its left and right half.
  std::vector<std::array<double, 2>> brightness{};
  /// Number of colours of each frame of a GIF.
  std::vector<std::size_t> colours{};
};

/// Throws std::runtime_error if it cannot be decoded.
VideoContent ReadVideo(const std::filesystem::path& file);

/// The names of an MP4 file's outermost boxes, in order.
std::vector<std::string> BoxesOf(const std::filesystem::path& file);

}  // namespace gauntlet::sim
