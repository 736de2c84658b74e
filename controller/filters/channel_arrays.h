#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <new>

#include "controller/assert.h"

namespace gauntlet::controller {

/// Several arrays with one value per channel: the state of a filter as a structure of arrays, each
/// beginning at a cache line so that vector loads do not straddle two. The last line of an array
/// may be read and written to its end.
class ChannelArrays {
 public:
  ChannelArrays(int array_count, int channel_count)
      : channel_count_(channel_count),
        stride_((static_cast<std::size_t>(channel_count) + kLineValues - 1) / kLineValues *
                kLineValues),
        size_(stride_ * static_cast<std::size_t>(array_count)),
        values_(new (kLine) double[size_]()) {
    GAUNTLET_ASSERT(array_count >= 0 && channel_count > 0);
  }

  static constexpr std::size_t kLineValues = 64 / sizeof(double);

  double* operator[](int array) noexcept { return values_.get() + Begin(array); }
  const double* operator[](int array) const noexcept { return values_.get() + Begin(array); }
  int channel_count() const noexcept { return channel_count_; }
  int array_count() const noexcept { return static_cast<int>(size_ / stride_); }

  void SetZero() noexcept { std::fill_n(values_.get(), size_, 0.0); }
  /// Arrays `first` to `last` - 1 from others with as many channels.
  void Copy(const ChannelArrays& from, int first, int last) noexcept {
    GAUNTLET_ASSERT(from.channel_count_ == channel_count_ && first <= last &&
                    last <= array_count());
    std::copy(from[first], from[last], (*this)[first]);
  }

 private:
  static constexpr std::align_val_t kLine{64};
  struct Free {
    void operator()(double* values) const { operator delete[](values, kLine); }
  };

  std::size_t Begin(int array) const noexcept {
    GAUNTLET_ASSERT(array >= 0 && stride_ * static_cast<std::size_t>(array) <= size_);
    return stride_ * static_cast<std::size_t>(array);
  }

  int channel_count_;
  std::size_t stride_;
  std::size_t size_;
  std::unique_ptr<double[], Free> values_;
};

}  // namespace gauntlet::controller
