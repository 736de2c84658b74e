#pragma once

#include <cstddef>
#include <span>

#include "controller/assert.h"
#include "controller/export.h"

namespace gauntlet::controller {

/// A causal filter of n channels that share a clock but not their state.
///
/// Step() takes one sample of every channel and gives one value of every channel. It neither throws
/// nor allocates. Its time does not depend on the data: decaying states become exactly 0 before
/// they are subnormal numbers, which are slow. Inputs are finite: the controller replaces an
/// invalid value by the last valid value of the channel.
///
/// Shapes: `input`, `output` and `values` have channel_count() values; `input` and `output` are the
/// same memory, or do not overlap. Units: those of the input; parameters with a unit name it.
/// Errors: other shapes or a channel out of range do nothing; in Gauntlet's own build they fail an
/// assertion.
class GAUNTLET_API Filter {
 public:
  virtual ~Filter() = default;

  /// Number of channels.
  int channel_count() const noexcept { return channel_count_; }
  /// One sample of every channel.
  void Step(std::span<const double> input, std::span<double> output) noexcept {
    if (Fits(input.size()) && Fits(output.size())) StepChecked(input, output);
  }
  /// The state after construction.
  virtual void Reset() noexcept = 0;
  /// One channel to the state after construction; the others keep every bit.
  void ResetChannel(int channel) noexcept {
    const bool exists = channel >= 0 && channel < channel_count_;
    GAUNTLET_ASSERT(exists);
    if (exists) ResetChecked(channel);
  }
  /// The state after the first sample `values`; a `start` of zero is ignored.
  void StartAt(std::span<const double> values) noexcept {
    if (Fits(values.size())) StartChecked(values);
  }
  /// Exchanges the states with `from`, so that settings can change while running. The settings
  /// stay. The time does not depend on the length of a window. False, without a change, if `from`
  /// is of another kind or has another history.
  bool SwapMemory(Filter& from) noexcept {
    return &from != this && from.channel_count_ == channel_count_ && SwapChecked(from);
  }

 protected:
  /// For derived classes.
  explicit Filter(int channel_count) : channel_count_(channel_count) {}

  /// `size` is the number of channels.
  bool Fits(std::size_t size) const noexcept {
    const bool fits = size == static_cast<std::size_t>(channel_count_);
    GAUNTLET_ASSERT(fits);
    return fits;
  }

 private:
  // The same with checked arguments.
  virtual void StepChecked(std::span<const double> input, std::span<double> output) noexcept = 0;
  virtual void ResetChecked(int channel) noexcept = 0;
  virtual void StartChecked(std::span<const double> values) noexcept = 0;
  virtual bool SwapChecked(Filter& from) noexcept = 0;

  int channel_count_;
};

}  // namespace gauntlet::controller
