#include "sim/score/mean_square_error.h"

#include <algorithm>
#include <utility>

#include "controller/filters/vectorise.h"

namespace gauntlet::sim {
namespace {

double Square(double value) { return value * value; }

/// Some columns side by side, whose sums stay in registers.
template <int kColumns>
inline void AddSquaresOf(const float* hand, std::ptrdiff_t hand_row, const float* reference,
                         std::ptrdiff_t reference_row, std::ptrdiff_t rows, double* squares) {
  double sums[kColumns];
  for (int i = 0; i < kColumns; ++i) sums[i] = squares[i];
  for (; rows > 0; --rows, hand += hand_row, reference += reference_row) {
    for (int i = 0; i < kColumns; ++i) {
      sums[i] += Square(static_cast<double>(hand[i]) - static_cast<double>(reference[i]));
    }
  }
  for (int i = 0; i < kColumns; ++i) squares[i] = sums[i];
}

/// Of the first `columns` of both, which have so many values in a row.
GAUNTLET_VECTORISED void AddSquares(const float* hand, std::ptrdiff_t hand_row,
                                    const float* reference, std::ptrdiff_t reference_row,
                                    std::ptrdiff_t rows, std::ptrdiff_t columns, double* squares) {
  std::ptrdiff_t i = 0;
  for (; i + 8 <= columns; i += 8) {
    AddSquaresOf<8>(hand + i, hand_row, reference + i, reference_row, rows, squares + i);
  }
  for (; i + 2 <= columns; i += 2) {
    AddSquaresOf<2>(hand + i, hand_row, reference + i, reference_row, rows, squares + i);
  }
  for (; i < columns; ++i) {
    AddSquaresOf<1>(hand + i, hand_row, reference + i, reference_row, rows, squares + i);
  }
}

}  // namespace

MeanSquareError::MeanSquareError(std::vector<int> columns, std::vector<CountedTicks> counted)
    : columns_(std::move(columns)), counted_(std::move(counted)) {
  for (const int column : columns_) {
    squares_.resize(std::max(squares_.size(), static_cast<std::size_t>(column) + 1));
  }
}

template <class Matrix>
bool MeanSquareError::AddPart(const Matrix& hand_rad, const Matrix& reference_rad) {
  const TickRange block{static_cast<int>(ticks_), static_cast<int>(ticks_ + hand_rad.rows())};
  ticks_ = block.end;
  const auto has_all = [&block](const CountedTicks& counted) {
    return std::ranges::any_of(counted, [&block](const TickRange& range) {
      return range.begin <= block.begin && block.end <= range.end;
    });
  };
  if (std::ranges::all_of(counted_, has_all)) return false;
  for (std::size_t j = 0; j < columns_.size(); ++j) {
    const int column = columns_[j];
    for (const TickRange& range : Overlap(counted_[j], {block})) {
      for (int n = range.begin - block.begin; n < range.end - block.begin; ++n) {
        squares_[column] += Square(static_cast<double>(hand_rad(n, column)) -
                                   static_cast<double>(reference_rad(n, column)));
      }
    }
  }
  return true;
}

void MeanSquareError::Add(const Angles& hand_rad, const Angles& reference_rad) {
  if (!AddPart(hand_rad, reference_rad)) AddWhole(hand_rad, reference_rad);
}

void MeanSquareError::Add(const AngleRows& hand_rad, const AngleRows& reference_rad) {
  if (AddPart(hand_rad, reference_rad)) return;
  AddSquares(hand_rad.data(), hand_rad.outerStride(), reference_rad.data(),
             reference_rad.outerStride(), hand_rad.rows(), std::ssize(squares_), squares_.data());
}

/// Some joints side by side: their sums do not wait for each other, as those of one joint's ticks
/// do.
void MeanSquareError::AddWhole(const Angles& hand_rad, const Angles& reference_rad) {
  constexpr std::size_t kTogether = 6;
  const double* hand[kTogether];
  const double* reference[kTogether];
  for (std::size_t first = 0; first < columns_.size(); first += kTogether) {
    const std::size_t count = std::min(kTogether, columns_.size() - first);
    double squares[kTogether] = {};
    for (std::size_t k = 0; k < kTogether; ++k) {
      const int column = columns_[first + std::min(k, count - 1)];  // beyond: for nothing
      squares[k] = squares_[column];
      hand[k] = hand_rad.col(column).data();
      reference[k] = reference_rad.col(column).data();
    }
    for (Eigen::Index n = 0; n < hand_rad.rows(); ++n) {
      for (std::size_t k = 0; k < kTogether; ++k)
        squares[k] += Square(hand[k][n] - reference[k][n]);
    }
    for (std::size_t k = 0; k < count; ++k) squares_[columns_[first + k]] = squares[k];
  }
}

}  // namespace gauntlet::sim
