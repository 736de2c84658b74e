#include "sim/hand/cable_span.h"

#include <cmath>

namespace gauntlet::sim {

SpanLength CableSpan::At(double angle_rad) const noexcept {
  const double x = angle_rad - reference_rad;
  const double arc = arc_m + radius_m * x;
  if (arc > 0.0) {
    const double unrolled = tangents_m + arc;
    const double length = std::sqrt(unrolled * unrolled + rise_m * rise_m);
    return {length, radius_m * unrolled / length};
  }
  const double sine = std::sin(x);
  const double cosine = std::cos(x);
  const double length = std::sqrt(square_m2 - 2.0 * (along_m2 * cosine + across_m2 * sine));
  return {length, (along_m2 * sine - across_m2 * cosine) / length};
}

}  // namespace gauntlet::sim
