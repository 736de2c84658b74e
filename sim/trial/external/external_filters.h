#pragma once

#include <exception>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "controller/controller_config.h"
#include "controller/filters/filter_registry.h"

namespace gauntlet::sim {

/// The consent of the person, by --allow-programs or an argument in Python: from now on, trials may
/// run the programs that scenarios name, or not any more. No file can give it.
void AllowPrograms(bool allowed = true);
/// A name that replaces what else tells each process from all others, where several work for one
/// call: filters whose answers are not deterministic are known again under it. Empty: none.
void NameRun(const std::string& name);
/// The consent as messages call it, in place of --allow-programs. `option` lives for ever.
void NameConsent(const char* option);

/// True if the controller has a filter that is a program, a library, an object (own_objects.h), or
/// a file of their answers (answer_filter.h).
bool HasPrograms(const controller::ControllerConfig& config);

/// True if one of them is no shared library: it has no place in real time.
bool HasSlowPrograms(const controller::ControllerConfig& config);

/// Finds what is wrong with the programs, libraries and objects of a controller; loads libraries,
/// and starts no program. Errors: SettingError `filter[i].command` or `.library` without the
/// consent, for one that is not there, and for a library that is no filter.
void CheckPrograms(const controller::ControllerConfig& config);
/// The controller with `none` in their place.
controller::ControllerConfig WithoutPrograms(controller::ControllerConfig config);
/// The files that decide what its programs do, as far as they are there.
std::vector<std::filesystem::path> ProgramFiles(const controller::ControllerConfig& config);
/// A hash of what decides the answers of its programs and objects; empty without any. It is another
/// at each consent if one of them is not said to be deterministic. Errors: SettingError, RunError.
std::string HashOfPrograms(const controller::ControllerConfig& config);

/// Why the programs of a trial failed.
struct TrialProblem {
  std::string text;  // of the first that failed; empty: none did
  std::exception_ptr mistake;
};

/// The programs and objects of one trial. Each is started at the filter's first sample, and ends
/// with the controller that is made of config(), while this object lives.
///
/// One that fails is not asked again: its filter passes its input on, and ok() is false. The trial
/// is then no trial of this controller. Units: those of the filter's input.
class TrialPrograms {
 public:
  /// Errors: as CheckPrograms().
  explicit TrialPrograms(const controller::ControllerConfig& config);

  const controller::ControllerConfig& config() const { return config_; }
  bool ok() const noexcept { return problem_->text.empty(); }
  /// Problem of the first that failed: "python3 my_filter.py: .. at sample 100".
  const std::string& problem() const { return problem_->text; }
  /// Errors: the SettingError of an object with which no trial of the controller can be run.
  void ThrowMistake(const std::string& controller) const;

 private:
  std::shared_ptr<TrialProblem> problem_;
  std::shared_ptr<const controller::FilterMaker> maker_;
  controller::ControllerConfig config_;
};

}  // namespace gauntlet::sim
