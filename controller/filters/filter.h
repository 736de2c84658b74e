#pragma once

#include <cstddef>
#include <span>

#include "controller/assert.h"

namespace gauntlet::controller {

/// A causal filter of n channels that share a clock but not their state.
///
/// Step() takes one sample of every channel and gives one value of every channel. It neither throws
/// nor allocates, and its time does not depend on the data: states that decay become exactly 0
/// before they are subnormal numbers, which processors compute with slowly. Inputs are finite: the
/// controller holds the last good value of a channel before the filter sees it.
///
/// Shapes: `input`, `output` and `values` have channel_count() values; `input` and `output` may be
/// the same memory, or are apart. Units: those of the input; parameters with a unit name it.
/// Errors: other shapes, or a channel that there is not, do nothing; in Gauntlet's own build they
/// fail an assertion.
class Filter {
 public:
  virtual ~Filter() = default;

  int channel_count() const noexcept { return channel_count_; }
  void Step(std::span<const double> input, std::span<double> output) noexcept {
    if (Fits(input.size()) && Fits(output.size())) StepChecked(input, output);
  }
  /// Back to the state after construction.
  virtual void Reset() noexcept = 0;
  /// One channel back to the state after construction; the others keep every bit.
  void ResetChannel(int channel) noexcept {
    const bool exists = channel >= 0 && channel < channel_count_;
    GAUNTLET_ASSERT(exists);
    if (exists) ResetChecked(channel);
  }
  /// As new, and as if `values` had been the first sample; a `start` of zero does not count.
  void StartAt(std::span<const double> values) noexcept {
    if (Fits(values.size())) StartChecked(values);
  }
  /// Takes the memory of `from`, which goes on with what was this filter's, so that settings can
  /// change while running. The settings stay. In a time that does not depend on the length of a
  /// window. False, and nothing changed, if `from` is of another kind or keeps another history.
  bool TakeMemory(Filter& from) noexcept {
    return &from != this && from.channel_count_ == channel_count_ && TakeChecked(from);
  }

 protected:
  explicit Filter(int channel_count) : channel_count_(channel_count) {}

  bool Fits(std::size_t size) const noexcept {
    const bool fits = size == static_cast<std::size_t>(channel_count_);
    GAUNTLET_ASSERT(fits);
    return fits;
  }

 private:
  /// The same, once it is sure that the arguments fit.
  virtual void StepChecked(std::span<const double> input, std::span<double> output) noexcept = 0;
  virtual void ResetChecked(int channel) noexcept = 0;
  virtual void StartChecked(std::span<const double> values) noexcept = 0;
  virtual bool TakeChecked(Filter& from) noexcept = 0;

  int channel_count_;
};

}  // namespace gauntlet::controller
