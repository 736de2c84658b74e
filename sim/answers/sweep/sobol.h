#pragma once

#include <cstdint>

namespace gauntlet::sim {

/// Dimensions for which SobolPoint() has direction numbers.
constexpr int kSobolDimensions = 21;

/// Coordinate of a point of Sobol's sequence, in (0, 1): the first 2^k points have one in each of
/// the 2^k equal parts of every coordinate, and fill boxes of the first two as evenly as can be.
///
///     x = (g_0 v_1 xor g_1 v_2 xor ... + 1/2) / 2^32,   g the bits of index xor (index >> 1)
///
/// Source: Joe, Kuo, SIAM J. Sci. Comput. 30 (2008), new-joe-kuo-6.21201; Antonov, Saleev 1979.
double SobolPoint(std::uint32_t index, int dimension);

}  // namespace gauntlet::sim
