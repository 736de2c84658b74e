#pragma once

#include <Eigen/Core>
#include <vector>

#include "controller/assert.h"
#include "sim/score/counted_ticks.h"

namespace gauntlet::sim {

/// Mean square error of each joint over the ticks that count, block by block, so that it can be
/// found while a trial runs and its angles are not kept:
///
///     mean over n of (hand[n] - reference[n])^2
///
/// However the ticks fall into blocks, the bits are the same. Shapes: ticks x joints. Units: rad,
/// rad^2.
class MeanSquareError {
 public:
  using Angles = Eigen::Ref<const Eigen::MatrixXd>;
  using Rows =
      Eigen::Ref<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;

  /// Of these columns, of each of which these ticks count.
  MeanSquareError(std::vector<int> columns, std::vector<CountedTicks> counted);

  /// The next ticks.
  void Add(const Angles& hand_rad, const Angles& reference_rad);
  /// The same, tick by tick. The hand's angles become as exact as a trace keeps them.
  void AddRows(const Rows& hand_rad, const Rows& reference_rad);

  int joint_count() const { return static_cast<int>(columns_.size()); }
  /// Of the joint in one of the columns; kNoScore if none of its ticks counts.
  double Of(int joint) const {
    GAUNTLET_ASSERT(0 <= joint && joint < joint_count());
    return squares_[columns_[joint]] / CountOf(counted_[joint]);
  }

 private:
  /// Counts the ticks in. False if all of them count for every joint; else what counts is added.
  template <class Matrix, class SquareAt>
  bool AddPart(const Matrix& hand_rad, const Matrix& reference_rad, const SquareAt& square_of);
  void AddWhole(const Angles& hand_rad, const Angles& reference_rad);

  std::vector<int> columns_;
  std::vector<CountedTicks> counted_;
  std::vector<double> squares_;  // per column; of those that are not of a joint anything
  std::vector<double> before_;   // scratch: of the last block
  Eigen::Index ticks_ = 0;
};

}  // namespace gauntlet::sim
