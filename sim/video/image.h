#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace gauntlet::sim {

/// A picture in memory, rows from the top. A pixel is 0xAARRGGBB with premultiplied alpha: what
/// Cairo calls ARGB32, so that text and curves are drawn into it without a copy.
struct Image {
  int width_px = 0;
  int height_px = 0;
  std::vector<std::uint32_t> pixels;

  Image() = default;
  Image(int width, int height)
      : width_px(width), height_px(height), pixels(std::ptrdiff_t{width} * height) {}

  std::uint32_t* Row(int y) { return pixels.data() + std::ptrdiff_t{y} * width_px; }
  const std::uint32_t* Row(int y) const { return pixels.data() + std::ptrdiff_t{y} * width_px; }
};

}  // namespace gauntlet::sim
