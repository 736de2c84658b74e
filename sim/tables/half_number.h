#pragma once

#include <cmath>
#include <cstdint>

#include "sim/tables/missing.h"

namespace gauntlet::sim {

/// Value of the bits of a 16-bit floating-point number. Source: IEEE 754, binary16.
inline double ValueOfHalf(std::uint16_t bits) {
  const int exponent = bits >> 10 & 31;
  const int fraction = bits & 1023;
  double value =
      std::ldexp(exponent == 0 ? fraction : fraction + 1024, exponent == 0 ? -24 : exponent - 25);
  if (exponent == 31) value = fraction == 0 ? HUGE_VAL : kMissing;
  return bits >> 15 != 0 ? -value : value;
}

}  // namespace gauntlet::sim
