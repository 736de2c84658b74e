#include "sim/answers/sweep/sobol.h"

#include <array>

namespace gauntlet::sim {
namespace {

/// Degree and coefficients of the primitive polynomial, and the first direction numbers, of each
/// dimension from the second on.
struct Polynomial {
  int degree;
  std::uint32_t coefficients;
  std::array<std::uint32_t, 7> first;
};
constexpr std::array<Polynomial, kSobolDimensions - 1> kPolynomials = {{
    {1, 0, {1}},
    {2, 1, {1, 3}},
    {3, 1, {1, 3, 1}},
    {3, 2, {1, 1, 1}},
    {4, 1, {1, 1, 3, 3}},
    {4, 4, {1, 3, 5, 13}},
    {5, 2, {1, 1, 5, 5, 17}},
    {5, 4, {1, 1, 5, 5, 5}},
    {5, 7, {1, 1, 7, 11, 19}},
    {5, 11, {1, 1, 5, 1, 1}},
    {5, 13, {1, 1, 1, 3, 11}},
    {5, 14, {1, 3, 5, 5, 31}},
    {6, 1, {1, 3, 3, 9, 7, 49}},
    {6, 13, {1, 1, 1, 15, 21, 21}},
    {6, 16, {1, 3, 1, 13, 27, 49}},
    {6, 19, {1, 1, 1, 15, 7, 5}},
    {6, 22, {1, 3, 1, 15, 13, 25}},
    {6, 25, {1, 1, 5, 5, 19, 61}},
    {7, 1, {1, 3, 7, 11, 23, 15, 103}},
    {7, 4, {1, 3, 7, 13, 13, 15, 69}},
}};

constexpr int kBits = 32;
using Directions = std::array<std::uint32_t, kBits>;

Directions DirectionsOf(int dimension) {
  Directions v{};
  if (dimension == 0) {
    for (int i = 0; i < kBits; ++i) v[i] = std::uint32_t{1} << (kBits - 1 - i);
    return v;
  }
  const auto& [degree, coefficients, first] = kPolynomials[dimension - 1];
  for (int i = 0; i < degree; ++i) v[i] = first[i] << (kBits - 1 - i);
  for (int i = degree; i < kBits; ++i) {
    v[i] = v[i - degree] ^ (v[i - degree] >> degree);
    for (int k = 1; k < degree; ++k) {
      if ((coefficients >> (degree - 1 - k) & 1) != 0) v[i] ^= v[i - k];
    }
  }
  return v;
}

}  // namespace

double SobolPoint(std::uint32_t index, int dimension) {
  static const auto kDirections = [] {
    std::array<Directions, kSobolDimensions> directions{};
    for (int d = 0; d < kSobolDimensions; ++d) directions[d] = DirectionsOf(d);
    return directions;
  }();
  const std::uint32_t gray = index ^ (index >> 1);
  std::uint32_t x = 0;
  for (int i = 0; i < kBits; ++i) {
    if ((gray >> i & 1) != 0) x ^= kDirections[dimension][i];
  }
  return (x + 0.5) * 0x1.0p-32;
}

}  // namespace gauntlet::sim
