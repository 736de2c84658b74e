#pragma once

#include <string>

namespace gauntlet::sim {

/// Tells machines apart whose mathematical functions (sin, exp, pow, ...) differ in the last bit:
/// the C library has others for processors with FMA and AVX2 than for those without, and other
/// versions of it may have others again. 16 hexadecimal digits, made of what the functions give.
std::string HashOfMathematics();

}  // namespace gauntlet::sim
