#include "sim/score/mean_square_error.h"

#include <algorithm>
#include <utility>

namespace gauntlet::sim {
namespace {

double Square(double value) { return value * value; }

}  // namespace

MeanSquareError::MeanSquareError(std::vector<int> columns, std::vector<CountedTicks> counted)
    : columns_(std::move(columns)), counted_(std::move(counted)), squares_(columns_.size()) {}

void MeanSquareError::Add(const Angles& hand_rad, const Angles& reference_rad) {
  const TickRange block{static_cast<int>(ticks_), static_cast<int>(ticks_ + hand_rad.rows())};
  ticks_ = block.end;
  const auto has_all = [&block](const CountedTicks& counted) {
    return std::ranges::any_of(counted, [&block](const TickRange& range) {
      return range.begin <= block.begin && block.end <= range.end;
    });
  };
  if (std::ranges::all_of(counted_, has_all)) return AddWhole(hand_rad, reference_rad);
  for (std::size_t j = 0; j < columns_.size(); ++j) {
    for (const TickRange& range : Overlap(counted_[j], {block})) {
      for (int n = range.begin - block.begin; n < range.end - block.begin; ++n) {
        squares_[j] += Square(hand_rad(n, columns_[j]) - reference_rad(n, columns_[j]));
      }
    }
  }
}

/// Some joints side by side: their sums do not wait for each other, as those of one joint's ticks
/// do.
void MeanSquareError::AddWhole(const Angles& hand_rad, const Angles& reference_rad) {
  constexpr std::size_t kTogether = 6;
  const double* hand[kTogether];
  const double* reference[kTogether];
  for (std::size_t first = 0; first < columns_.size(); first += kTogether) {
    double squares[kTogether] = {};
    for (std::size_t k = 0; k < kTogether; ++k) {
      const std::size_t joint = std::min(first + k, columns_.size() - 1);  // beyond: for nothing
      squares[k] = squares_[joint];
      hand[k] = hand_rad.col(columns_[joint]).data();
      reference[k] = reference_rad.col(columns_[joint]).data();
    }
    for (Eigen::Index n = 0; n < hand_rad.rows(); ++n) {
      for (std::size_t k = 0; k < kTogether; ++k)
        squares[k] += Square(hand[k][n] - reference[k][n]);
    }
    const std::size_t count = std::min(kTogether, columns_.size() - first);
    std::copy_n(squares, count, squares_.begin() + static_cast<std::ptrdiff_t>(first));
  }
}

}  // namespace gauntlet::sim
