#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "controller/filters/external_filter.h"
#include "controller/settings.h"
#include "sim/trial/external/command_words.h"
#include "sim/trial/external/program.h"

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

/// Starts the program of an external filter. `limit`: the longest wait for an answer.
///
///     -> {"rate_hz": 1e3, "channel_count": 2, "channels": ["a", "b"], "parameters": {"x": 0.1}}
///     -> 512,498.25
///     <- 512,498.25      and so on, a line for a line
///
/// Errors: as of Program.
std::unique_ptr<Stepper> StartProgram(const ProgramCommand& command, const FilterFacts& facts,
                                      Program::Duration limit);

/// The shared library of an external filter. Errors: SettingError `library` or `folder` if it is
/// not there.
std::filesystem::path FindLibrary(const controller::ExternalConfig& config);

/// Loads the shared library of an external filter (controller/c_api/gauntlet_filter.h); its code
/// runs in this process from now on. Returns what makes a filter of it.
/// Errors: SettingError `library` for one that is not there, cannot be loaded or is no filter. Of
/// what is returned: SettingError for facts that the filter refuses.
std::function<std::unique_ptr<Stepper>(const FilterFacts&)> LoadLibrary(
    const controller::ExternalConfig& config);

}  // namespace gauntlet::sim
