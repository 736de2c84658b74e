#pragma once

#include <filesystem>
#include <string>

namespace gauntlet::sim {

/// True if a file is a model of a hand, by its ending.
bool IsHandFile(const std::filesystem::path& file);

/// Builds the hand of an MJCF, as a scenario would, and prints its motors, joints and linkages.
/// Numbers of motors that the file does not have are assumed for this. Writes a starter scenario to
/// `scenario`, if it is not empty, with these numbers and a joint map.
/// Errors: UserError for what docs/how-to/your-hand-model.md asks for and the file does not have;
/// without `scenario` also for numbers of motors that are missing.
void InspectHand(const std::filesystem::path& file, const std::string& scenario, bool force);

}  // namespace gauntlet::sim
