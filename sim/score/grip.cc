#include "sim/score/grip.h"

#include <algorithm>
#include <cmath>

#include "sim/score/jitter.h"
#include "sim/score/no_score.h"

namespace gauntlet::sim {
namespace {

constexpr double kTouchN = 0.1;

}  // namespace

double GripForceRipple(std::span<const double> force_n, double rate_hz, double above_hz,
                       Fourier& fourier) {
  double squares = 0.0;
  Eigen::Index count = 0;
  const auto holds = [](double force) { return force >= kTouchN; };
  auto begin = std::find_if(force_n.begin(), force_n.end(), holds);
  while (begin != force_n.end()) {
    const auto end = std::find_if_not(begin, force_n.end(), holds);
    const Signal stretch = Eigen::Map<const Eigen::VectorXd>(&*begin, end - begin);
    const Signal ripple = Trembling(stretch, rate_hz, above_hz, fourier).values;
    squares += ripple.squaredNorm();
    count += ripple.rows();
    begin = std::find_if(end, force_n.end(), holds);
  }
  return count == 0 ? kNoScore : std::sqrt(squares / static_cast<double>(count));
}

}  // namespace gauntlet::sim
