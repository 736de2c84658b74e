#include "sim/show/video/ghost.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace gauntlet::sim {
namespace {

constexpr double kShapeAlpha = 0.45;
constexpr double kOutlineAlpha = 0.9;
constexpr int kCommonEdge = 2;  // apart by up to so many widths of the outline

/// The colour as a pixel with this coverage.
std::uint32_t Pixel(const Color& color, double alpha) {
  const auto part = [alpha](double value) {
    return static_cast<std::uint32_t>(std::lround(255.0 * alpha * value));
  };
  return part(1.0) << 24 | part(color.red) << 16 | part(color.green) << 8 | part(color.blue);
}

struct Range {
  std::uint32_t least;
  std::uint32_t most;
};

/// How opaque a picture is within `reach` pixels of one.
Range AlphaAround(const Image& picture, int x, int y, int reach) {
  Range alpha = {255, 0};
  for (int v = std::max(0, y - reach); v <= std::min(picture.height_px - 1, y + reach); ++v) {
    for (int u = std::max(0, x - reach); u <= std::min(picture.width_px - 1, x + reach); ++u) {
      const std::uint32_t here = picture.Row(v)[u] >> 24;
      alpha = {std::min(alpha.least, here), std::max(alpha.most, here)};
    }
  }
  return alpha;
}

/// The colour at each coverage.
std::array<std::uint32_t, 256> Shades(const Color& color, double alpha) {
  std::array<std::uint32_t, 256> shades{};
  for (int cover = 0; cover < 256; ++cover) shades[cover] = Pixel(color, alpha * cover / 255.0);
  return shades;
}

}  // namespace

void Ghost::SetHand(const Image& hand) {
  const int width = hand.width_px, height = hand.height_px;
  if (shape_.width_px != width || shape_.height_px != height) {
    shape_ = outline_ = Image(width, height);
    edge_.resize(shape_.pixels.size());
  }
  const auto shades = Shades(color_, kShapeAlpha);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const std::uint32_t cover = hand.Row(y)[x] >> 24;
      shape_.Row(y)[x] = shades[cover];
      // The shape less the shape made thinner.
      edge_[std::ptrdiff_t{y} * width + x] = static_cast<std::uint8_t>(
          cover == 0 ? 0 : cover - AlphaAround(hand, x, y, outline_px_).least);
    }
  }
}

const Image& Ghost::OutlineOver(const Image& hand) {
  const auto shades = Shades(color_, kOutlineAlpha);
  for (int y = 0; y < outline_.height_px; ++y) {
    for (int x = 0; x < outline_.width_px; ++x) {
      const int edge = edge_[std::ptrdiff_t{y} * outline_.width_px + x];
      bool common = false;
      if (edge > 0) {
        const Range alpha = AlphaAround(hand, x, y, kCommonEdge * outline_px_);
        common = alpha.most - alpha.least > 127;
      }
      outline_.Row(y)[x] = common ? 0 : shades[edge];
    }
  }
  return outline_;
}

}  // namespace gauntlet::sim
