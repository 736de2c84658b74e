#pragma once

#include <span>
#include <string>
#include <vector>

#include "controller/settings.h"

namespace gauntlet::sim {

/// The facts that an external filter gets before its first sample.
struct FilterFacts {
  double rate_hz = 0.0;
  std::vector<std::string> channels;
  std::vector<controller::NamedNumber> parameters;
};

/// The other side of an external filter: a program, or an object of the caller of this library.
class Stepper {
 public:
  virtual ~Stepper() = default;

  /// One sample of every channel in, one value of every channel out, in the same units.
  /// Errors: RunError whose text is the end of a sentence ("answered 1 value, must be 2"): the
  /// trial fails. SettingError: no trial of this filter can be run. Cancelled.
  virtual void Step(std::span<const double> input, std::span<double> output) = 0;
  /// The next sample of a channel is as its first one: before, its samples were not trusted for a
  /// while. Errors: as Step().
  virtual void StartChannel(int channel) = 0;

 protected:
  Stepper() = default;
  Stepper(const Stepper&) = default;
  Stepper& operator=(const Stepper&) = default;
};

}  // namespace gauntlet::sim
