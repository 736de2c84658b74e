#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/show/video/image.h"

namespace gauntlet::sim {

/// The colours of a GIF, chosen from pictures by median cut. Pixels get the nearest of them,
/// without dithering: even areas stay even, and frames differ only where something moves.
class GifPalette {
 public:
  /// 256 entries of a GIF, less the one that says "as in the frame before".
  static constexpr std::size_t kColours = 255;

  explicit GifPalette(std::span<const ImageView> pictures);

  /// 0xffrrggbb, at most kColours.
  const std::vector<std::uint32_t>& colours() const { return colours_; }
  /// Index of the nearest colour; alpha is not looked at.
  std::uint8_t IndexOf(std::uint32_t pixel) const { return nearest_[CellOf(pixel)]; }

 private:
  // Colours that differ by less than 4 of 255 in each part are one.
  static constexpr int kBits = 6;
  static constexpr std::size_t CellOf(std::uint32_t pixel) {
    constexpr std::uint32_t kMask = (1u << kBits) - 1;
    const auto part = [pixel](int shift) { return pixel >> (shift + 8 - kBits) & kMask; };
    return part(16) << (2 * kBits) | part(8) << kBits | part(0);
  }

  std::vector<std::uint32_t> colours_;
  std::vector<std::uint8_t> nearest_;  // of each cell
};

}  // namespace gauntlet::sim
