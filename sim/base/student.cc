#include "sim/base/student.h"

#include <cmath>
#include <unsupported/Eigen/SpecialFunctions>

#include "controller/assert.h"

namespace gauntlet::sim {

double StudentProbability(double t, double degrees_of_freedom) {
  return Eigen::numext::betainc(0.5 * degrees_of_freedom, 0.5,
                                degrees_of_freedom / (degrees_of_freedom + t * t));
}

double StudentHalfWidth(double level, double degrees_of_freedom) {
  GAUNTLET_ASSERT(0.0 < level && level < 1.0);
  // Root of ln(probability) as a function of ln(t), which is nearly linear in the tail. Illinois
  // method: regula falsi with half the weight for an end that is kept twice.
  const auto excess = [&](double log_t) {
    return std::log(StudentProbability(std::exp(log_t), degrees_of_freedom)) - std::log1p(-level);
  };
  double low = -1.0, high = 1.0;
  double above = excess(low), below = excess(high);
  while (above < 0.0) above = excess(low *= 2.0);
  while (below > 0.0) below = excess(high *= 2.0);
  int last = 0;
  while (high - low > 1e-12) {
    const double share = std::isinf(below) ? 0.5 : above / (above - below);
    const double middle = low + share * (high - low);
    const double value = excess(middle);
    if (std::abs(value) < 1e-12) return std::exp(middle);
    if (value > 0.0) {
      low = middle;
      above = value;
      if (last == 1) below *= 0.5;
      last = 1;
    } else {
      high = middle;
      below = value;
      if (last == -1) above *= 0.5;
      last = -1;
    }
  }
  return std::exp(high);
}

}  // namespace gauntlet::sim
