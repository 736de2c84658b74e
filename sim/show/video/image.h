#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace gauntlet::sim {

/// The pixels of a picture, which live elsewhere; rows from the top. A pixel is 0xAARRGGBB with
/// premultiplied alpha: what Cairo calls ARGB32, so that text and curves are drawn without a copy.
struct ImageView {
  int width_px = 0;
  int height_px = 0;
  std::uint32_t* pixels = nullptr;
};

/// A picture in memory, as ImageView has it.
struct Image {
  int width_px = 0;
  int height_px = 0;
  std::vector<std::uint32_t> pixels;

  Image() = default;
  Image(int width, int height)
      : width_px(width), height_px(height), pixels(std::ptrdiff_t{width} * height) {}

  std::uint32_t* Row(int y) { return pixels.data() + std::ptrdiff_t{y} * width_px; }
  const std::uint32_t* Row(int y) const { return pixels.data() + std::ptrdiff_t{y} * width_px; }

  /// To draw into. NOLINTNEXTLINE(google-explicit-constructor): it is the same picture.
  operator ImageView() { return {width_px, height_px, pixels.data()}; }
};

}  // namespace gauntlet::sim
