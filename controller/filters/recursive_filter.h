#pragma once

#include "controller/filters/channel_arrays.h"
#include "controller/filters/filter.h"
#include "controller/filters/fresh_channels.h"
#include "controller/filters/start.h"

namespace gauntlet::controller {

/// Base of filters whose whole memory is a few numbers per channel: each channel starts by itself,
/// at its first sample or at zero.
class RecursiveFilter : public Filter {
 public:
  void Reset() noexcept final;

 protected:
  RecursiveFilter(int state_count, int channel_count, Start start = Start::kFirst)
      : Filter(channel_count),
        arrays_(state_count, channel_count),
        fresh_(channel_count),
        start_(start) {
    Reset();
  }

  /// One step of all channels; `input` and `output` may be the same memory.
  virtual void StepAll(const double* input, double* output) noexcept = 0;
  /// The state that `value` for all time up to now leaves behind; all other states are 0.
  virtual void SettleAt(int channel, double value) noexcept = 0;

  double* state(int index) noexcept { return arrays_[index]; }

 private:
  void StepChecked(std::span<const double> input, std::span<double> output) noexcept final;
  void ResetChecked(int channel) noexcept final;
  void StartChecked(std::span<const double> values) noexcept final;
  bool SwapChecked(Filter& from) noexcept final;

  ChannelArrays arrays_;
  FreshChannels fresh_;
  Start start_;
};

}  // namespace gauntlet::controller
