#include "sim/score/tracking.h"

#include <algorithm>
#include <cmath>

#include "sim/score/no_score.h"

namespace gauntlet::sim {

double Rms(std::span<const double> values) {
  double squares = 0.0;
  for (const double value : values) squares += value * value;
  return std::sqrt(squares / static_cast<double>(values.size()));
}

std::vector<double> Differences(std::span<const double> values, std::span<const double> others) {
  std::vector<double> differences(std::min(values.size(), others.size()));
  for (std::size_t i = 0; i < differences.size(); ++i) differences[i] = values[i] - others[i];
  return differences;
}

double RmsWithin(std::span<const double> values, int first_tick,
                 const std::vector<TickRange>& ranges) {
  double squares = 0.0;
  int count = 0;
  for (const TickRange& range : ranges) {
    const int begin = std::max(0, range.begin - first_tick);
    const int end = std::min(static_cast<int>(values.size()), range.end - first_tick);
    for (int n = begin; n < end; ++n) squares += values[n] * values[n];
    count += std::max(0, end - begin);
  }
  return count == 0 ? kNoScore : std::sqrt(squares / count);
}

double PeakWithin(std::span<const double> values, const std::vector<TickRange>& ranges) {
  double peak = kNoScore;
  for (const TickRange& range : ranges) {
    for (int n = range.begin; n < range.end; ++n) peak = std::fmax(peak, std::abs(values[n]));
  }
  return peak;
}

double ReversalsPerSecond(std::span<const int> command, double rate_hz,
                          const std::vector<TickRange>& ranges) {
  int reversals = 0;
  for (const TickRange& range : ranges) {
    int direction = 0;
    for (int n = range.begin + 1; n < range.end; ++n) {
      if (command[n] == command[n - 1]) continue;
      const int now = command[n] > command[n - 1] ? 1 : -1;
      if (direction == -now) ++reversals;
      direction = now;
    }
  }
  const int count = CountOf(ranges);
  return count == 0 ? kNoScore : reversals * rate_hz / static_cast<double>(count);
}

}  // namespace gauntlet::sim
