#pragma once

#include <filesystem>
#include <string>

#include "sim/cli/shared_options.h"
#include "sim/recordings/inspect/inspection.h"

namespace gauntlet::sim {

/// True for the name of a recording, by its ending; scenarios are YAML.
bool IsRecordingFile(const std::filesystem::path& file);

/// As a file in the folder of `from` names it.
std::string SeenFrom(const std::filesystem::path& from, const std::filesystem::path& file);

/// Writes a file that a person may edit, and reports it.
void WriteStarter(const std::string& target, const std::string& text, bool force);

/// Errors: UserError with the question that is open, and what answers it. `map` is the starter map
/// that was written; empty: none.
void CheckQuestion(const Inspection& inspection, const std::string& map);

/// Options of commands that read a recording: what a person knows and the file does not say.
struct RecordingArguments {
  InspectionOptions inspection;
  std::string columns;  // FIRST-LAST; empty: found

  Options Rows();
  /// Those of a command that takes a scenario or a recording: --map, too.
  Options RowsBesideScenario();
  /// Errors: UserError for columns that are no range.
  InspectionOptions Asked() const;
  /// The first option that is given, with its value; empty: none.
  std::string Given() const;
};

/// The scenario that a person gives, or that of a recording, written into the folder. Errors:
/// UserError, also for options of recordings beside a scenario.
std::string ScenarioOrOfRecording(const std::string& given, const RecordingArguments& recording,
                                  const std::filesystem::path& folder);

/// Writes the starter scenario of a recording into the folder, as `gauntlet inspect
/// --write-scenario` does, and returns its name. Errors: UserError for an open question, and
/// without a map for assumed joints.
std::string ScenarioOfRecording(const std::filesystem::path& recording,
                                const InspectionOptions& options,
                                const std::filesystem::path& folder);

}  // namespace gauntlet::sim
