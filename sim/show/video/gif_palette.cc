#include "sim/show/video/gif_palette.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace gauntlet::sim {
namespace {

constexpr int kParts = 3;  // red, green, blue

/// Mean colour of the pixels of a cell, and how much it counts.
struct Cell {
  std::array<double, kParts> colour{};
  double weight = 0.0;
};

double DistanceOf(const std::array<double, kParts>& a, const std::array<double, kParts>& b) {
  // The eye sees differences of green best and of blue least.
  constexpr std::array<double, kParts> kWeights = {3.0, 4.0, 2.0};
  double sum = 0.0;
  for (int p = 0; p < kParts; ++p) sum += kWeights[p] * (a[p] - b[p]) * (a[p] - b[p]);
  return sum;
}

std::array<double, kParts> MeanOf(std::span<const Cell> cells) {
  std::array<double, kParts> sum{};
  double weight = 0.0;
  for (const Cell& cell : cells) {
    for (int p = 0; p < kParts; ++p) sum[p] += cell.weight * cell.colour[p];
    weight += cell.weight;
  }
  for (double& part : sum) part /= weight;
  return sum;
}

/// A set of cells that will share a colour.
struct Box {
  std::span<Cell> cells;
  double error = 0.0;  // weighted sum of squared distances from the mean

  explicit Box(std::span<Cell> all) : cells(all) {
    const auto mean = MeanOf(cells);
    for (const Cell& cell : cells) error += cell.weight * DistanceOf(cell.colour, mean);
  }
};

/// Divides the box where its longest side has half of the weight on either side.
std::pair<Box, Box> Halves(const Box& box) {
  const auto mean = MeanOf(box.cells);
  std::array<double, kParts> spread{};
  for (const Cell& cell : box.cells) {
    for (int p = 0; p < kParts; ++p) {
      spread[p] += cell.weight * std::pow(cell.colour[p] - mean[p], 2);
    }
  }
  const auto longest = std::ranges::max_element(spread) - spread.begin();
  std::ranges::sort(box.cells, {}, [longest](const Cell& cell) {
    auto key = cell.colour;
    std::swap(key[0], key[static_cast<std::size_t>(longest)]);
    return key;
  });
  double all = 0.0, left = 0.0;
  for (const Cell& cell : box.cells) all += cell.weight;
  std::size_t half = 0;
  while (half + 1 < box.cells.size() && (half == 0 || left < 0.5 * all)) {
    left += box.cells[half++].weight;
  }
  return {Box(box.cells.first(half)), Box(box.cells.subspan(half))};
}

std::uint32_t PixelOf(const std::array<double, kParts>& colour) {
  std::uint32_t pixel = 0xff;
  for (const double part : colour) {
    pixel = pixel << 8 | static_cast<std::uint32_t>(std::lround(part));
  }
  return pixel;
}

std::array<double, kParts> ColourOf(std::uint32_t pixel) {
  return {static_cast<double>(pixel >> 16 & 0xff), static_cast<double>(pixel >> 8 & 0xff),
          static_cast<double>(pixel & 0xff)};
}

}  // namespace

GifPalette::GifPalette(std::span<const ImageView> pictures) {
  constexpr std::size_t kCells = std::size_t{1} << (3 * kBits);
  std::vector<Cell> counted(kCells);
  for (const ImageView& picture : pictures) {
    const auto size = static_cast<std::size_t>(picture.width_px) * picture.height_px;
    for (const std::uint32_t pixel : std::span(picture.pixels, size)) {
      Cell& cell = counted[CellOf(pixel)];
      const auto colour = ColourOf(pixel);
      for (int p = 0; p < kParts; ++p) cell.colour[p] += colour[p];
      cell.weight += 1.0;
    }
  }
  std::vector<Cell> cells;
  for (Cell& cell : counted) {
    if (cell.weight == 0.0) continue;
    for (double& part : cell.colour) part /= cell.weight;
    // Grounds are large, and text and thin curves are small: these must not lose their colours.
    cell.weight = std::sqrt(cell.weight);
    cells.push_back(cell);
  }
  std::vector<Box> boxes;
  if (!cells.empty()) boxes.emplace_back(cells);
  while (!boxes.empty() && boxes.size() < kColours) {
    const auto worst = std::ranges::max_element(boxes, {}, &Box::error);
    if (worst->cells.size() < 2) break;
    auto [left, right] = Halves(*worst);
    *worst = left;
    boxes.push_back(right);
  }
  for (const Box& box : boxes) colours_.push_back(PixelOf(MeanOf(box.cells)));
  nearest_.resize(kCells);
  std::vector<std::array<double, kParts>> places;
  for (const std::uint32_t colour : colours_) places.push_back(ColourOf(colour));
  for (std::size_t cell = 0; cell < kCells; ++cell) {
    constexpr std::uint32_t kMask = (1u << kBits) - 1;
    std::array<double, kParts> middle{};
    for (int p = 0; p < kParts; ++p) {
      const std::size_t part = cell >> ((kParts - 1 - p) * kBits) & kMask;
      middle[p] = 255.0 / kMask * static_cast<double>(part);
    }
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t c = 0; c < places.size(); ++c) {
      const double distance = DistanceOf(middle, places[c]);
      if (distance < least) {
        least = distance;
        nearest_[cell] = static_cast<std::uint8_t>(c);
      }
    }
  }
}

}  // namespace gauntlet::sim
