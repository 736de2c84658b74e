#pragma once

#include <string>

namespace gauntlet::sim {

/// Hash that differs between machines whose sin, exp, pow, ... differ in the last bit. The C
/// library has different versions of these functions for processors with and without FMA and AVX2.
/// 16 hexadecimal digits, computed from values of the functions.
std::string HashOfMathematics();

}  // namespace gauntlet::sim
