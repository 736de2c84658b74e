#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "controller/assert.h"

namespace gauntlet::controller {

/// The last `length` samples of every channel. Rows are moments, so that a loop over channels
/// reads memory in order. A channel that was reset starts empty again while the others keep theirs.
class SampleWindow {
 public:
  /// Places that are not filled yet hold `empty`.
  SampleWindow(int length, int channel_count, double empty = 0.0);

  int length() const noexcept { return rows_.rows(); }
  int channel_count() const noexcept { return rows_.cols(); }

  /// The row that the next Push() overwrites: the sample that leaves the window.
  const double* Leaving() const noexcept { return rows_.row(next_).data(); }
  /// Which of rows() that is.
  int leaving_place() const noexcept { return next_; }
  /// The sample of `age` steps ago; 0 is the newest.
  const double* Row(int age) const noexcept {
    GAUNTLET_ASSERT(0 <= age && age < length());
    const int row = next_ - 1 - age;
    return rows_.row(row < 0 ? row + length() : row).data();
  }
  /// All rows in the order of memory, and which of them is the newest; older ones go before it.
  const double* rows() const noexcept { return rows_.data(); }
  int newest() const noexcept { return next_ == 0 ? length() - 1 : next_ - 1; }
  void Push(std::span<const double> sample) noexcept;
  /// As Push(), of a sample that the caller writes: into the row of the leaving one, which is given
  /// as it was.
  double* Advance() noexcept;

  /// How many samples of the channel the window holds.
  int count(int channel) const noexcept {
    GAUNTLET_ASSERT(0 <= channel && channel < channel_count());
    return counts_[channel];
  }
  bool all_full() const noexcept { return filling_ == 0; }

  void Reset() noexcept;
  void ResetChannel(int channel) noexcept;
  /// Empty but for one sample.
  void StartAt(std::span<const double> sample) noexcept {
    Reset();
    Push(sample);
  }

 private:
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  void SetCount(int channel, int count) noexcept;

  Rows rows_;
  double empty_;
  int next_ = 0;
  std::vector<int> counts_;
  int filling_;  // channels whose window is not full
};

}  // namespace gauntlet::controller
