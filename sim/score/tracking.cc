#include "sim/score/tracking.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace gauntlet::sim {

double RmsDifference(std::span<const double> reference, std::span<const double> hand) {
  double squares = 0.0;
  for (std::size_t n = 0; n < hand.size(); ++n) {
    const double error = hand[n] - reference[n];
    squares += error * error;
  }
  return std::sqrt(squares / static_cast<double>(hand.size()));
}

double PeakDifference(std::span<const double> reference, std::span<const double> hand) {
  if (hand.empty()) return std::numeric_limits<double>::quiet_NaN();
  double peak = 0.0;
  for (std::size_t n = 0; n < hand.size(); ++n) {
    peak = std::max(peak, std::abs(hand[n] - reference[n]));
  }
  return peak;
}

double Rms(std::span<const double> values) {
  double squares = 0.0;
  for (const double value : values) squares += value * value;
  return std::sqrt(squares / static_cast<double>(values.size()));
}

double ReversalsPerSecond(std::span<const int> command, double rate_hz) {
  int reversals = 0;
  int direction = 0;
  for (std::size_t n = 1; n < command.size(); ++n) {
    if (command[n] == command[n - 1]) continue;
    const int now = command[n] > command[n - 1] ? 1 : -1;
    if (direction == -now) ++reversals;
    direction = now;
  }
  return reversals * rate_hz / static_cast<double>(command.size());
}

}  // namespace gauntlet::sim
