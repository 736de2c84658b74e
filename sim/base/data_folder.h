#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace gauntlet::sim {

/// A folder of the files that Gauntlet brings along: "models" or "scenarios". They lie in
/// share/gauntlet beside the program's own folder (`<prefix>/share/gauntlet` for
/// `<prefix>/bin/gauntlet`) or one above it, as in the build tree; the variable GAUNTLET_DATA_DIR
/// names another place. So an installed Gauntlet can be moved as a whole.
///
/// Errors: UserError if GAUNTLET_DATA_DIR has no such folder, RunError if the program has none.
std::filesystem::path DataFolder(const std::string& name);

/// The file that a user means: `file` itself if it is there, else the one of that name that
/// Gauntlet brings along, so that scenarios/hold_still.yaml means one in every working folder. If
/// neither is there: `file`.
std::filesystem::path OwnOrDataFile(const std::filesystem::path& file);

/// The file of this name ("scenarios/recordings/a.csv") that Gauntlet brings along, if there is
/// one. Names that lead out of its folders are none.
std::optional<std::filesystem::path> DataFile(const std::filesystem::path& name);

/// The name that DataFile() finds this file by; empty for a file that Gauntlet does not bring
/// along. `file` is absolute.
std::string DataName(const std::filesystem::path& file);

/// How a file in `folder` names an absolute path, so that both can be moved together: relative to
/// it, or as DataName(). Without a folder, and of a relative path, as it is.
std::string PathFrom(const std::filesystem::path& folder, const std::filesystem::path& file);

/// A library that only this program loads, in lib/gauntlet beside its own folder or one above it.
/// Errors: RunError if it is in neither.
std::filesystem::path OwnLibrary(const std::string& name);

}  // namespace gauntlet::sim
