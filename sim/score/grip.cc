#include "sim/score/grip.h"

#include <algorithm>
#include <cmath>

#include "controller/assert.h"
#include "sim/score/jitter.h"
#include "sim/score/no_score.h"

namespace gauntlet::sim {
double GripForceRipple(std::span<const double> force_n, double rate_hz, double above_hz,
                       const CountedTicks& counted, Fourier& fourier) {
  GAUNTLET_ASSERT(AreWithin(counted, std::ssize(force_n)));
  double squares = 0.0;
  Eigen::Index count = 0;
  const auto holds = [](double force) { return force >= kTouchN; };
  for (const TickRange& range : counted) {
    const auto last = force_n.begin() + range.end;
    auto begin = std::find_if(force_n.begin() + range.begin, last, holds);
    while (begin != last) {
      const auto end = std::find_if_not(begin, last, holds);
      const Signal stretch = Eigen::Map<const Eigen::VectorXd>(&*begin, end - begin);
      const Signal ripple = Trembling(stretch, rate_hz, above_hz, fourier).values;
      squares += ripple.squaredNorm();
      count += ripple.rows();
      begin = std::find_if(end, last, holds);
    }
  }
  return count == 0 ? kNoScore : std::sqrt(squares / static_cast<double>(count));
}

}  // namespace gauntlet::sim
