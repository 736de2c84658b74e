#include "sim/score/mean_square_error.h"

#include <algorithm>
#include <utility>

#include "controller/assert.h"
#include "controller/filters/lanes.h"
#include "controller/filters/vectorise.h"

namespace gauntlet::sim {
namespace {

using controller::ForParts;
using controller::kLanes;
using controller::Lanes;
using controller::LoadLanes;
using controller::StoreLanes;

double Square(double value) { return value * value; }

/// Angles of both, a tick after the other; so many values in a row.
struct TwoRows {
  const double* hand;
  const double* reference;
  std::ptrdiff_t hand_row, reference_row;
  std::ptrdiff_t rows;
};

double SquareOfKept(double hand, double reference) {
  return Square(static_cast<double>(static_cast<float>(hand)) - reference);
}

/// Of some columns, whose sums stay in registers; the last four may be in part those before them.
template <int kCount>
GAUNTLET_INLINE void AddSquaresOf(TwoRows angles, int first, int count, const double* before,
                                  double* squares) {
  using Floats = float __attribute__((vector_size(16)));
  std::ptrdiff_t begin[kCount];
  Lanes sums[kCount];
  for (int i = 0; i < kCount; ++i) {
    begin[i] = i + 1 < kCount ? first + i * kLanes : first + count - kLanes;
    LoadLanes(before + begin[i], sums[i]);
  }
  for (; angles.rows > 0; --angles.rows) {
    for (int i = 0; i < kCount; ++i) {
      Lanes hand;
      Lanes reference;
      LoadLanes(angles.hand + begin[i], hand);
      LoadLanes(angles.reference + begin[i], reference);
      const Floats kept = __builtin_convertvector(hand, Floats);
      const Lanes error = __builtin_convertvector(kept, Lanes) - reference;
      sums[i] += error * error;
    }
    angles.hand += angles.hand_row;
    angles.reference += angles.reference_row;
  }
  for (int i = 0; i < kCount; ++i) StoreLanes(sums[i], squares + begin[i]);
}

/// Of the first `columns`, to what `before` holds.
GAUNTLET_VECTORISED void AddSquares(const TwoRows& angles, int columns, const double* before,
                                    double* squares) {
  if (columns >= kLanes) {
    ForParts(
        columns, [&]<int kCount>(int first, int count) __attribute__((always_inline)) {
          AddSquaresOf<kCount>(angles, first, count, before, squares);
        });
    return;
  }
  for (int i = 0; i < columns; ++i) {
    double sum = before[i];
    for (std::ptrdiff_t row = 0; row < angles.rows; ++row) {
      sum += SquareOfKept(angles.hand[row * angles.hand_row + i],
                          angles.reference[row * angles.reference_row + i]);
    }
    squares[i] = sum;
  }
}

}  // namespace

MeanSquareError::MeanSquareError(std::vector<int> columns, std::vector<CountedTicks> counted)
    : columns_(std::move(columns)), counted_(std::move(counted)) {
  GAUNTLET_ASSERT(counted_.size() == columns_.size());
  for (const int column : columns_) {
    squares_.resize(std::max(squares_.size(), static_cast<std::size_t>(column) + 1));
  }
}

template <class Matrix, class SquareAt>
bool MeanSquareError::AddPart(const Matrix& hand_rad, const Matrix& reference_rad,
                              const SquareAt& square_of) {
  GAUNTLET_ASSERT(reference_rad.rows() == hand_rad.rows());
  GAUNTLET_ASSERT(hand_rad.cols() >= std::ssize(squares_) &&
                  reference_rad.cols() >= std::ssize(squares_));
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
        squares_[column] += square_of(hand_rad(n, column), reference_rad(n, column));
      }
    }
  }
  return true;
}

void MeanSquareError::Add(const Angles& hand_rad, const Angles& reference_rad) {
  const auto square = [](double hand, double reference) { return Square(hand - reference); };
  if (!AddPart(hand_rad, reference_rad, square)) AddWhole(hand_rad, reference_rad);
}

void MeanSquareError::AddRows(const Rows& hand_rad, const Rows& reference_rad) {
  if (AddPart(hand_rad, reference_rad, SquareOfKept)) return;
  before_ = squares_;
  AddSquares({.hand = hand_rad.data(),
              .reference = reference_rad.data(),
              .hand_row = hand_rad.outerStride(),
              .reference_row = reference_rad.outerStride(),
              .rows = hand_rad.rows()},
             static_cast<int>(squares_.size()), before_.data(), squares_.data());
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
