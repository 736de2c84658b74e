#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace gauntlet::sim {

/// `text` as one word of a command that a person copies or a script runs, on one line: as it is
/// where a shell takes it so, else in quotes; with control characters, or bytes that are not UTF-8,
/// as bash writes them: $'a\nb'.
std::string ShellWord(std::string_view text);

/// The same of a file or folder, which is never taken for an option: `-a` becomes `./-a`.
std::string ShellPath(const std::filesystem::path& path);

}  // namespace gauntlet::sim
