#pragma once

#include <span>

namespace gauntlet::controller {

/// A causal filter of n channels that share a clock but not their state.
///
/// Step() takes one sample of every channel and gives one value of every channel. It neither throws
/// nor allocates, and its time does not depend on the data. Inputs are finite: the controller holds
/// the last good value of a channel before the filter sees it.
///
/// Shapes: `input` and `output` have channel_count() values and may be the same memory.
/// Units: those of the input; parameters with a unit name it.
class Filter {
 public:
  virtual ~Filter() = default;

  virtual int channel_count() const noexcept = 0;
  virtual void Step(std::span<const double> input, std::span<double> output) noexcept = 0;
  /// Back to the state after construction.
  virtual void Reset() noexcept = 0;
  /// One channel back to the state after construction; the others keep every bit.
  virtual void ResetChannel(int channel) noexcept = 0;
  /// Takes over what `from` knows of one channel, so that settings can change while running.
  /// False, and nothing changed, if `from` is of another kind or keeps another history.
  virtual bool CopyChannel(const Filter& from, int channel) noexcept = 0;
};

}  // namespace gauntlet::controller
