#include "sim/video/running_scores.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/score/jitter.h"

namespace gauntlet::sim {
namespace {

/// Mean over columns of the RMS of the rows shown up to each frame. Row 0 is sample `first_sample`.
std::vector<double> RunningRms(const Signal& angle_rad, int first_sample, const FrameClock& clock) {
  const int rows = angle_rad.rows();
  Eigen::ArrayXd sum = Eigen::ArrayXd::Zero(angle_rad.cols());
  std::vector<double> result;
  int row = 0;
  for (int frame = 0; frame < clock.FrameCount(); ++frame) {
    // A frame stands for all samples until the next one.
    const int end = std::clamp(clock.Sample(frame + 1) - first_sample, 0, rows);
    TrimSignals();
    for (; row < end; ++row) sum += angle_rad.row(row).transpose().array().square();
    result.push_back(row == 0 ? std::numeric_limits<double>::quiet_NaN()
                              : kDegPerRad * (sum / row).sqrt().mean());
  }
  return result;
}

}  // namespace

RunningScores ComputeRunningScores(const Signal& true_angle_rad, const Signal& hand_angle_rad,
                                   double rate_hz, double jitter_above_hz,
                                   const FrameClock& clock) {
  Fourier fourier;
  const FilteredSignal trembling = Trembling(hand_angle_rad, rate_hz, jitter_above_hz, fourier);
  const Signal difference = hand_angle_rad - true_angle_rad.topRows(hand_angle_rad.rows());
  return {.tracking_rmse_deg = RunningRms(difference, 0, clock),
          .jitter_rms_deg = RunningRms(trembling.values, trembling.first_sample, clock)};
}

}  // namespace gauntlet::sim
