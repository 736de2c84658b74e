#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace gauntlet::sim {

/// A folder of Gauntlet's own files: "models" or "scenarios". It is in share/gauntlet next to the
/// program's folder (`<prefix>/share/gauntlet` for `<prefix>/bin/gauntlet`), or one level higher,
/// as in the build tree. GAUNTLET_DATA_DIR names another place. So an installed Gauntlet can be
/// moved as a whole.
///
/// Errors: UserError if GAUNTLET_DATA_DIR has no such folder, RunError if the program has none.
std::filesystem::path DataFolder(const std::string& name);

/// Gauntlet's own files are in this folder, unless GAUNTLET_DATA_DIR names another one. For a
/// library of another program, which does not lie beside that program. To be called before all
/// others.
void SetDataFolder(const std::filesystem::path& folder);

/// The file that a user means: `file` if it exists, else Gauntlet's own file of that name. So
/// scenarios/hold_still.yaml works in every working folder. `file` if neither exists.
std::filesystem::path OwnOrDataFile(const std::filesystem::path& file);

/// OwnOrDataFile(), or the ready file of this name in `folder` ("scenarios", "studies"). `noun`:
/// what it is called in messages. Errors: UserError for what is neither, with the nearest name.
std::string ReadyFile(const std::string& given, const std::string& folder, const std::string& noun);

/// Gauntlet's own file of this name ("scenarios/recordings/a.csv"); none if it does not exist or
/// the name leads out of Gauntlet's folders.
std::optional<std::filesystem::path> DataFile(const std::filesystem::path& name);

/// The name by which DataFile() finds this file; empty if it is not Gauntlet's own. `file` is
/// absolute.
std::string DataName(const std::filesystem::path& file);

/// An absolute path as a file in `folder` names it, so that both can be moved together: relative to
/// `folder`, or as DataName(). Unchanged if there is no folder or the path is relative.
std::string PathFrom(const std::filesystem::path& folder, const std::filesystem::path& file);

/// A library for this program only, in lib/gauntlet next to the program's folder or one level
/// higher.
/// Errors: RunError if it is in neither place.
std::filesystem::path OwnLibrary(const std::string& name);

}  // namespace gauntlet::sim
