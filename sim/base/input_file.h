#pragma once

#include <filesystem>

namespace gauntlet::sim {

/// The door through which every file is read that a person names, on the command line or in
/// another file: scenarios, recordings, maps, hands, logs, results. From then on no output replaces
/// it (see output_file.h). Returns `file`.
/// Errors: UserError for a file that is missing, is no regular file (a pipe or a device may wait
/// for ever) or lies outside the folder of ReadOnlyInside().
const std::filesystem::path& InputFile(const std::filesystem::path& file);

/// From now on inputs outside `folder`, links resolved, are refused. Gauntlet's own files remain.
/// Errors: UserError if it is no folder.
void ReadOnlyInside(const std::filesystem::path& folder);
/// The folder of ReadOnlyInside(); empty without a limit.
std::filesystem::path InputRoot();
/// Errors: UserError for a path outside InputRoot(), whether there is a file or not.
void RefuseOutside(const std::filesystem::path& path);

/// True if the file at `path`, links followed, was read as an input.
bool IsInput(const std::filesystem::path& path);

}  // namespace gauntlet::sim
