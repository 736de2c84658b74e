#include "sim/answers/compare/decisive_second.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace gauntlet::sim {
namespace {

constexpr double kLength_s = 1.0;
constexpr double kStep_s = 0.05;

/// Adds the mean over joints of the squared difference of two hands, tick by tick.
void AddDifference(const Signal& hand_rad, const Signal& other_rad, const std::vector<int>& joints,
                   std::vector<double>& difference) {
  for (const int joint : joints) {
    for (std::size_t tick = 0; tick < difference.size(); ++tick) {
      const auto row = static_cast<Eigen::Index>(tick);
      const double off_rad = other_rad(row, joint) - hand_rad(row, joint);
      difference[tick] += off_rad * off_rad / static_cast<double>(joints.size());
    }
    TrimSignals();
  }
}

}  // namespace

std::optional<DecisiveSecond> DecisiveSecondOf(const FinishedStudy& finished) {
  const std::vector<Trace>& traces = finished.result.first_traces;
  const std::vector<std::size_t>& shown = finished.summary.answer.shown;
  if (traces.size() != finished.summary.controllers.size() || shown.size() < 2) return std::nullopt;
  Eigen::Index ticks = traces[shown.front()].hand_angle_rad.rows();
  for (const std::size_t c : shown) ticks = std::min(ticks, traces[c].hand_angle_rad.rows());
  if (ticks == 0) return std::nullopt;
  std::vector<double> difference(static_cast<std::size_t>(ticks), 0.0);
  for (const std::size_t c : shown) {
    if (c == shown.front()) continue;
    AddDifference(traces[shown.front()].hand_angle_rad, traces[c].hand_angle_rad,
                  finished.study.measured_joints, difference);
  }
  const double rate_hz = finished.result.first_glove->tick_rate_hz;
  const auto length =
      std::min<Eigen::Index>(ticks, static_cast<Eigen::Index>(std::lround(kLength_s * rate_hz)));
  const auto step =
      std::max<Eigen::Index>(1, static_cast<Eigen::Index>(std::lround(kStep_s * rate_hz)));
  double largest = -1.0;
  auto begin = difference.begin();
  for (Eigen::Index from = 0; from + length <= ticks; from += step) {
    const auto first = difference.begin() + from;
    const double sum = std::accumulate(first, first + length, 0.0);
    if (sum > largest) {
      largest = sum;
      begin = first;
    }
  }
  const auto time_s = [&](auto at) {
    return static_cast<double>(at - difference.begin()) / rate_hz;
  };
  return DecisiveSecond{.from_s = time_s(begin),
                        .to_s = time_s(begin + length),
                        .moment_s = time_s(std::max_element(begin, begin + length))};
}

}  // namespace gauntlet::sim
