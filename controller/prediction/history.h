#pragma once

#include <algorithm>
#include <vector>

#include "controller/assert.h"

namespace gauntlet::controller {

/// The last `length` rows of `columns` values each. A column can be made to look as if one value
/// had always been there, so that what is computed of it needs no case for the first samples.
class History {
 public:
  History(int length, int columns)
      : length_(length),
        columns_(columns),
        values_(static_cast<std::size_t>(length) * static_cast<std::size_t>(columns), 0.0) {
    GAUNTLET_ASSERT(length > 0 && columns >= 0);
  }

  int length() const noexcept { return length_; }
  /// The row of `age` pushes ago; 0 is the newest. age < length.
  const double* Row(int age) const noexcept {
    GAUNTLET_ASSERT(0 <= age && age < length_);
    const int row = newest_ - age;
    return values_.data() + std::ptrdiff_t{row < 0 ? row + length_ : row} * columns_;
  }
  /// The memory of a new row, which takes the oldest one's place.
  double* Push() noexcept {
    newest_ = newest_ + 1 == length_ ? 0 : newest_ + 1;
    return values_.data() + std::ptrdiff_t{newest_} * columns_;
  }
  void Fill(int column, double value) noexcept {
    GAUNTLET_ASSERT(0 <= column && column < columns_);
    for (std::size_t i = static_cast<std::size_t>(column); i < values_.size();
         i += static_cast<std::size_t>(columns_)) {
      values_[i] = value;
    }
  }

 private:
  int length_;
  int columns_;
  int newest_ = 0;
  std::vector<double> values_;
};

}  // namespace gauntlet::controller
