#include "sim/score/fingertip_error.h"

#include <Eigen/Core>
#include <cmath>

#include "controller/assert.h"
#include "sim/score/no_score.h"

namespace gauntlet::sim {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

constexpr double kPinchBelow_m = 0.04;

Vector3d TipAt(const Signal& tips_m, Index row, int tip) {
  return tips_m.row(row).segment<3>(3 * Index{tip});
}

/// RMS of what `visit(row, add)` adds for rows whose tick counts.
template <class Visit>
double RmsOverRows(const FingertipSignals& tips, const CountedTicks& counted, const Visit& visit) {
  GAUNTLET_ASSERT(tips.ticks_per_row > 0 && tips.hand_m->cols() == tips.reference_m->cols());
  double squares = 0.0;
  Index count = 0;
  for (const TickRange& range : counted) {
    const Index step = tips.ticks_per_row;
    const Index end = (range.end + step - 1) / step;
    for (Index row = (range.begin + step - 1) / step; row < end; ++row) {
      visit(row, [&](double error) {
        squares += error * error;
        ++count;
      });
    }
  }
  return count == 0 ? kNoScore : std::sqrt(squares / static_cast<double>(count));
}

}  // namespace

double FingertipError(const FingertipSignals& tips, const CountedTicks& counted) {
  return RmsOverRows(tips, counted, [&](Index row, const auto& add) {
    for (const int tip : tips.measured) {
      add((TipAt(*tips.hand_m, row, tip) - TipAt(*tips.reference_m, row, tip)).norm());
    }
  });
}

double PinchDistanceError(const FingertipSignals& tips, const CountedTicks& counted) {
  return RmsOverRows(tips, counted, [&](Index row, const auto& add) {
    for (const auto& [thumb, finger] : tips.pinches) {
      const auto distance = [&, first = thumb, second = finger](const Signal& places_m) {
        return (TipAt(places_m, row, first) - TipAt(places_m, row, second)).norm();
      };
      const double reference_m = distance(*tips.reference_m);
      if (reference_m < kPinchBelow_m) add(distance(*tips.hand_m) - reference_m);
    }
  });
}

}  // namespace gauntlet::sim
