#pragma once

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "controller/filters/filter.h"
#include "controller/filters/fresh_channels.h"
#include "controller/filters/start.h"

namespace gauntlet::controller {

/// Base of the Kalman filters: a channel's first sample is its first estimate, exactly, and what
/// the step made of it is overwritten. (RecursiveFilter settles at that sample, then steps.)
///
/// `Interface` is Filter, or one that derives from it.
template <class Interface>
class StateFilter : public Interface {
 public:
  void Reset() noexcept override {
    for (int channel = 0; channel < this->channel_count(); ++channel) this->ResetChannel(channel);
  }

 protected:
  /// The constructor of the filter itself calls Reset().
  StateFilter(Start start, int channel_count)
      : Interface(channel_count), start_(start), first_(channel_count), fresh_(channel_count) {}

  void StepChecked(std::span<const double> input, std::span<double> output) noexcept override {
    if (!fresh_.any()) {
      StepAll(input, output);
      return;
    }
    std::copy(input.begin(), input.end(), first_.begin());  // `output` may be the same memory
    StepAll(input, output);
    fresh_.StartAll(first_, [&](int channel, double value) {
      SetState(channel, value);
      output[channel] = value;
    });
  }
  void ResetChecked(int channel) noexcept override {
    SetState(channel, 0.0);
    if (start_ == Start::kFirst) fresh_.Add(channel);
  }
  void StartChecked(std::span<const double> values) noexcept override {
    fresh_.AddAll();
    fresh_.StartAll(values, [this](int channel, double value) { SetState(channel, value); });
  }

  /// One step of all channels; `input` and `output` may be the same memory.
  virtual void StepAll(std::span<const double> input, std::span<double> output) noexcept = 0;
  /// At rest at a position, P = I.
  virtual void SetState(int channel, double position) noexcept = 0;

  /// Which channels still wait for their first sample, from the filter whose memory is taken.
  void SwapFresh(StateFilter& from) noexcept { std::swap(fresh_, from.fresh_); }

 private:
  Start start_;
  std::vector<double> first_;
  FreshChannels fresh_;
};

}  // namespace gauntlet::controller
