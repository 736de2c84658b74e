#pragma once

#include <Eigen/Core>
#include <vector>

namespace gauntlet::controller {

/// A stretch of samples [begin, end) in which the wearer held still.
struct StillStretch {
  Eigen::Index begin = 0;
  Eigen::Index end = 0;
};

/// Stretches of at least `min_duration_s` in which no channel moves: levels of 50 ms stay where
/// the stretch began and where the last one was, within what the noise of each channel allows. The
/// 50 ms beside a motion are left out. A level is the mean without spikes.
///
/// The noise is judged from differences of samples at most 32 ms apart, which motion hardly
/// touches, in the quietest quarter of the recording. Noise that is correlated over longer than
/// that looks like slow motion.
/// Shapes: `counts` is samples x channels, finite. Errors: none; no stretch is an empty list.
std::vector<StillStretch> FindStillStretches(const Eigen::MatrixXd& counts, double rate_hz,
                                             double min_duration_s = 0.5);

}  // namespace gauntlet::controller
