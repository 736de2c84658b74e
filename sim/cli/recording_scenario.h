#pragma once

#include <filesystem>
#include <string>

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

/// Writes the starter scenario of a recording into the folder, as `gauntlet inspect
/// --write-scenario` does, and returns its name. `map` is a filled-in column map, `array` an array
/// or a topic; empty: none. Errors: UserError for an open question, and without a map for assumed
/// joints.
std::string ScenarioOfRecording(const std::filesystem::path& recording, const std::string& map,
                                const std::string& array, const std::filesystem::path& folder);

}  // namespace gauntlet::sim
