#pragma once

#include <Eigen/Core>
#include <vector>

#include "sim/score/counted_ticks.h"

namespace gauntlet::sim {

/// Mean square error of joints over the ticks that count, block by block, for trials whose angles
/// are not kept:
///
///     mean over n of (hand[n] - reference[n])^2
///
/// The bits do not depend on the size of the blocks. Shapes: ticks x joints of the hand.
/// Units: rad, rad^2.
class MeanSquareError {
 public:
  using Rows =
      Eigen::Ref<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;

  /// Error of these joints of the hand, over the counted ticks of each.
  MeanSquareError(std::vector<int> joints, std::vector<CountedTicks> counted);

  /// Adds the next ticks. The hand's angles are rounded as a trace keeps them (see Stored).
  void Add(const Rows& hand_rad, const Rows& reference_rad);

  /// One value per joint that is measured; kNoScore if none of its ticks counts.
  std::vector<double> Values() const;

 private:
  /// Finds the joints that count at this tick, and until when that holds.
  void FindCounted();

  std::vector<int> joints_;
  std::vector<CountedTicks> counted_;
  std::vector<double> counts_;   // per joint of the hand: 1 if this tick counts, else 0
  std::vector<double> squares_;  // per joint of the hand
  int tick_ = 0;
  int counts_until_ = 0;
};

}  // namespace gauntlet::sim
