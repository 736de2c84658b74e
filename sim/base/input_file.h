#pragma once

#include <filesystem>

namespace gauntlet::sim {

/// Registers a file before it is read. Every file that a user names, on the command line or in
/// another file, passes through here: scenarios, recordings, maps, hands, logs, results. From then
/// on no output replaces it (see output_file.h). Returns `file`.
/// Errors: UserError if the file is missing, is not regular (a pipe or a device may block forever),
/// or is outside the folder of ReadOnlyInside().
const std::filesystem::path& InputFile(const std::filesystem::path& file);

/// Restricts all later inputs to `folder`, with links resolved. Gauntlet's own files stay allowed.
/// Errors: UserError if `folder` is no folder.
void ReadOnlyInside(const std::filesystem::path& folder);
/// The folder of ReadOnlyInside(); empty without a limit.
std::filesystem::path InputRoot();
/// True for a path outside InputRoot(), links resolved, also if no file is there. What Gauntlet
/// looks for by itself is then as if it were not there.
bool IsOutside(const std::filesystem::path& path);
/// Errors: UserError for one that IsOutside().
void RefuseOutside(const std::filesystem::path& path);

/// True if the file at `path`, links followed, was read as an input.
bool IsInput(const std::filesystem::path& path);

}  // namespace gauntlet::sim
