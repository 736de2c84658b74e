#include "sim/score/mean_square_error.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "controller/assert.h"
#include "controller/filters/vectorise.h"

namespace gauntlet::sim {
namespace {

struct TwoRows {
  const double *hand, *reference;
  Eigen::Index hand_stride, reference_stride;
};

GAUNTLET_VECTORISED void AddSquares(TwoRows angles, Eigen::Index rows, const double* counts,
                                    double* squares, int joint_count) {
  for (; rows > 0; --rows) {
    const double* hand = angles.hand;
    const double* reference = angles.reference;
    GAUNTLET_CHANNEL_LOOP
    for (int i = 0; i < joint_count; ++i) {
      const double error = static_cast<double>(static_cast<float>(hand[i])) - reference[i];
      const double square = error * error;
      squares[i] += counts[i] == 1.0 ? square : 0.0;
    }
    angles.hand += angles.hand_stride;
    angles.reference += angles.reference_stride;
  }
}

}  // namespace

MeanSquareError::MeanSquareError(std::vector<int> joints, std::vector<CountedTicks> counted)
    : joints_(std::move(joints)), counted_(std::move(counted)) {
  GAUNTLET_ASSERT(counted_.size() == joints_.size());
  const int most = joints_.empty() ? -1 : std::ranges::max(joints_);
  squares_.resize(static_cast<std::size_t>(most) + 1);
  counts_.resize(squares_.size());
}

void MeanSquareError::Add(const Rows& hand_rad, const Rows& reference_rad) {
  GAUNTLET_ASSERT(reference_rad.rows() == hand_rad.rows());
  GAUNTLET_ASSERT(hand_rad.cols() >= std::ssize(squares_));
  GAUNTLET_ASSERT(reference_rad.cols() >= std::ssize(squares_));
  for (Eigen::Index row = 0; row < hand_rad.rows();) {
    if (tick_ == counts_until_) FindCounted();
    const Eigen::Index rows = std::min<Eigen::Index>(hand_rad.rows() - row, counts_until_ - tick_);
    AddSquares({.hand = hand_rad.data() + row * hand_rad.outerStride(),
                .reference = reference_rad.data() + row * reference_rad.outerStride(),
                .hand_stride = hand_rad.outerStride(),
                .reference_stride = reference_rad.outerStride()},
               rows, counts_.data(), squares_.data(), static_cast<int>(squares_.size()));
    row += rows;
    tick_ += static_cast<int>(rows);
  }
}

void MeanSquareError::FindCounted() {
  counts_until_ = std::numeric_limits<int>::max();
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    double& counts = counts_[joints_[i]];
    counts = 0.0;
    for (const auto& [begin, end] : counted_[i]) {
      if (begin <= tick_ && tick_ < end) counts = 1.0;
      for (const int edge : {begin, end}) {
        if (edge > tick_) counts_until_ = std::min(counts_until_, edge);
      }
    }
  }
}

std::vector<double> MeanSquareError::Values() const {
  std::vector<double> values;
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    values.push_back(squares_[joints_[i]] / CountOf(counted_[i]));
  }
  return values;
}

}  // namespace gauntlet::sim
