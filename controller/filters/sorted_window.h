#pragma once

#include <limits>
#include <memory>
#include <span>

#include "controller/filters/sample_window.h"

namespace gauntlet::controller {

/// The last samples of every channel in order of size.
class SortedWindow {
 public:
  /// Short windows keep their samples sorted in rows of all channels, long ones the order alone:
  /// a step takes a time in proportion to the length or hardly more than to its logarithm.
  static std::unique_ptr<SortedWindow> Make(int length, int channel_count);

  virtual ~SortedWindow() = default;

  int length() const noexcept { return window_.length(); }
  int channel_count() const noexcept { return window_.channel_count(); }
  int count(int channel) const noexcept { return window_.count(channel); }

  virtual void Push(std::span<const double> sample) noexcept = 0;
  /// The sample that was pushed last.
  const double* newest() const noexcept { return window_.Row(0); }
  /// The smallest (rank 0), second smallest, ... sample of a channel. Places that are not filled
  /// yet come last and are infinite.
  virtual double Value(int rank, int channel) const noexcept = 0;

  /// The medians of all channels; of an even count the mean of the middle two.
  virtual void Medians(double* median) const noexcept;
  /// The medians of |sample - center| of all channels, as needed beside Medians().
  virtual void MedianDeviations(const double* center, double* deviation) const noexcept;

  void Reset() noexcept;
  void ResetChannel(int channel) noexcept;
  /// Empty but for one sample.
  void StartAt(std::span<const double> sample) noexcept {
    Reset();
    Push(sample);
  }

 protected:
  static constexpr double kEmpty = std::numeric_limits<double>::infinity();

  SortedWindow(int length, int channel_count) : window_(length, channel_count, kEmpty) {}

  /// The order of a channel whose places are all empty.
  virtual void EmptyOrder(int channel) noexcept = 0;

  SampleWindow window_;
};

}  // namespace gauntlet::controller
