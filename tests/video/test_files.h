#pragma once

#include <cairo.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <string>

#include "sim/show/video/image.h"

namespace gauntlet::sim {

/// How many threads a process with one thread has: the thread sanitizer adds its own.
#if defined(__SANITIZE_THREAD__)
inline constexpr int kOneThread = 2;
#else
inline constexpr int kOneThread = 1;
#endif

/// A folder of its own for one test, removed with all that is in it.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "gauntlet_video_XXXXXX").string();
    path_ = mkdtemp(name.data());
  }
  ~TemporaryFolder() { std::filesystem::remove_all(path_); }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  bool IsEmpty() const { return std::filesystem::is_empty(path_); }

 private:
  std::filesystem::path path_;
};

/// A PNG file as Cairo reads it. Throws std::runtime_error if it cannot.
inline Image ReadPng(const std::filesystem::path& file) {
  cairo_surface_t* read = cairo_image_surface_create_from_png(file.c_str());
  if (cairo_surface_status(read) != CAIRO_STATUS_SUCCESS) throw std::runtime_error(file.string());
  Image image(cairo_image_surface_get_width(read), cairo_image_surface_get_height(read));
  for (int y = 0; y < image.height_px; ++y) {
    std::memcpy(image.Row(y),
                cairo_image_surface_get_data(read) + y * cairo_image_surface_get_stride(read),
                sizeof(std::uint32_t) * static_cast<std::size_t>(image.width_px));
  }
  cairo_surface_destroy(read);
  return image;
}

}  // namespace gauntlet::sim
