#pragma once

#include <Eigen/Core>
#include <limits>
#include <span>
#include <vector>

#include "controller/assert.h"
#include "controller/filters/sample_window.h"

namespace gauntlet::controller {

/// The last samples of every channel in order of size. One pass of minima and maxima takes the
/// leaving sample out and the entering one in, in a time that does not depend on the data.
class SortedWindow {
 public:
  SortedWindow(int length, int channel_count);

  int length() const noexcept { return window_.length(); }
  int channel_count() const noexcept { return window_.channel_count(); }
  int count(int channel) const noexcept { return window_.count(channel); }
  bool all_full() const noexcept { return window_.all_full(); }

  void Push(std::span<const double> sample) noexcept;
  /// The sample that was pushed last.
  const double* newest() const noexcept { return window_.Row(0); }
  /// The smallest, second smallest, ... samples, one row of all channels each. Places that are not
  /// filled yet come last and are infinite.
  const double* row(int rank) const noexcept {
    GAUNTLET_ASSERT(0 <= rank && rank < length());
    return sorted_.data() + std::ptrdiff_t{rank} * channel_count();
  }

  void Reset() noexcept;
  void ResetChannel(int channel) noexcept;
  /// Empty but for one sample.
  void StartAt(std::span<const double> sample) noexcept {
    Reset();
    Push(sample);
  }

 private:
  static constexpr double kEmpty = std::numeric_limits<double>::infinity();

  SampleWindow window_;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> sorted_;
  std::vector<double> carried_;  // scratch of Push()
  std::vector<double> removed_;
};

/// The medians of all channels; of an even count the mean of the middle two.
void Medians(const SortedWindow& window, double* median) noexcept;

/// The medians of |sample - center| of all channels, as needed beside Medians().
void MedianDeviations(const SortedWindow& window, const double* center, double* deviation) noexcept;

}  // namespace gauntlet::controller
