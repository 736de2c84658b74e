#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "controller/filters/filter.h"
#include "controller/filters/fresh_channels.h"
#include "controller/filters/start.h"

namespace gauntlet::controller {

/// What the Kalman filters share: a channel's first sample is its first estimate, exactly, and what
/// the step made of it is overwritten. (RecursiveFilter settles at that sample, then steps.)
///
/// `Interface` is Filter, or one that derives from it.
template <class Interface>
class StateFilter : public Interface {
 public:
  int channel_count() const noexcept final { return fresh_.channel_count(); }

  void Step(std::span<const double> input, std::span<double> output) noexcept override {
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
  void Reset() noexcept override {
    for (int channel = 0; channel < channel_count(); ++channel) this->ResetChannel(channel);
  }
  void ResetChannel(int channel) noexcept override {
    SetState(channel, 0.0);
    if (start_ == Start::kFirst) fresh_.Add(channel);
  }

 protected:
  /// The constructor of the filter itself calls Reset().
  StateFilter(Start start, int channel_count)
      : start_(start), first_(channel_count), fresh_(channel_count) {}

  /// One step of all channels; `input` and `output` may be the same memory.
  virtual void StepAll(std::span<const double> input, std::span<double> output) noexcept = 0;
  /// At rest at a position, P = I.
  virtual void SetState(int channel, double position) noexcept = 0;

  /// Whether a channel still waits for its first sample, from the filter that it is copied from.
  void CopyFresh(const StateFilter& from, int channel) noexcept {
    fresh_.CopyFrom(from.fresh_, channel);
  }

 private:
  Start start_;
  std::vector<double> first_;
  FreshChannels fresh_;
};

}  // namespace gauntlet::controller
