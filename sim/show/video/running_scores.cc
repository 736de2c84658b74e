#include "sim/show/video/running_scores.h"

#include <algorithm>
#include <cmath>

#include "sim/score/jitter.h"

namespace gauntlet::sim {
namespace {

/// The mean square of one channel over its ticks that count, up to now.
class RunningSquare {
 public:
  /// `counted` outlives it.
  explicit RunningSquare(const CountedTicks& counted) : left_(counted) {}

  /// Ticks come in their order.
  void Add(int tick, double value) {
    while (!left_.empty() && left_.front().end <= tick) left_ = left_.subspan(1);
    if (left_.empty() || tick < left_.front().begin) return;
    sum_ += value * value;
    ++count_;
  }
  bool exists() const { return count_ > 0; }
  double Rms() const { return std::sqrt(sum_ / count_); }

 private:
  std::span<const TickRange> left_;
  double sum_ = 0.0;
  int count_ = 0;
};

/// Mean over columns of the RMS of the rows shown up to each frame. Row 0 is sample `first_sample`.
std::vector<double> RunningRms(const Signal& angle_rad, int first_sample,
                               const std::vector<CountedTicks>& counted, const FrameClock& clock) {
  const int rows = angle_rad.rows();
  std::vector<RunningSquare> channels(counted.begin(), counted.end());
  std::vector<double> result;
  int row = 0;
  for (int frame = 0; frame < clock.FrameCount(); ++frame) {
    // A frame stands for all samples until the next one.
    const int end = std::clamp(clock.Sample(frame + 1) - first_sample, 0, rows);
    TrimSignals();
    for (; row < end; ++row) {
      for (std::size_t c = 0; c < channels.size(); ++c) {
        channels[c].Add(first_sample + row, angle_rad(row, static_cast<Eigen::Index>(c)));
      }
    }
    double sum_rad = 0.0;
    int count = 0;
    for (const RunningSquare& channel : channels) {
      if (!channel.exists()) continue;
      sum_rad += channel.Rms();
      ++count;
    }
    result.push_back(count == 0 ? kNaN : kDegPerRad * sum_rad / count);
  }
  return result;
}

}  // namespace

RunningScores ComputeRunningScores(const Signal& true_angle_rad, const Signal& hand_angle_rad,
                                   double rate_hz, double jitter_above_hz, const FrameClock& clock,
                                   std::span<const CountedTicks> counted) {
  const std::vector<TickRange> all = {{0, static_cast<int>(hand_angle_rad.rows())}};
  std::vector<CountedTicks> errors_counted(hand_angle_rad.cols(), all), trembling_counted;
  for (std::size_t c = 0; c < counted.size(); ++c) errors_counted[c] = Overlap(all, counted[c]);
  for (const CountedTicks& ticks : errors_counted) {
    trembling_counted.push_back(TremblingWithin(ticks, rate_hz, jitter_above_hz));
  }
  Fourier fourier;
  const FilteredSignal trembling = Trembling(hand_angle_rad, rate_hz, jitter_above_hz, fourier);
  const Signal difference = hand_angle_rad - true_angle_rad.topRows(hand_angle_rad.rows());
  return {.tracking_rmse_deg = RunningRms(difference, 0, errors_counted, clock),
          .jitter_rms_deg =
              RunningRms(trembling.values, trembling.first_sample, trembling_counted, clock)};
}

}  // namespace gauntlet::sim
