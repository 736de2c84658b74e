#include "sim/base/mathematics.h"

#include <array>
#include <cmath>
#include <span>

#include "sim/base/hash.h"

namespace gauntlet::sim {

std::string HashOfMathematics() {
  // Enough points to detect functions that differ at one point in a thousand.
  constexpr int kPoints = 4096;
  Hash hash;
  for (int i = 1; i <= kPoints; ++i) {
    const double x = static_cast<double>(i) / kPoints;  // 0 < x <= 1
    const std::array<double, 10> values = {
        std::sin(7.0 * x),  std::cos(7.0 * x), std::tan(1.5 * x), std::asin(x),     std::acos(x),
        std::atan(9.0 * x), std::exp(x),       std::log(x),       std::pow(x, 1.7), std::tanh(x),
    };
    hash.Add(std::span<const double>(values));
  }
  return hash.Text();
}

}  // namespace gauntlet::sim
